import { Header } from "../app/Header";

export function DrivesPage() {
  return <Header />;
}
