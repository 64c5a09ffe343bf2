/** Whether the server answers. One failed request marks it lost; one answer, of any status, brings it back. */

import { create } from "zustand";

interface Connection {
  lost: boolean;
  answered: () => void;
  failed: () => void;
}

export const useConnection = create<Connection>()((set, get) => ({
  lost: false,
  answered: () => {
    if (get().lost) set({ lost: false });
  },
  failed: () => {
    if (!get().lost) set({ lost: true });
  },
}));
