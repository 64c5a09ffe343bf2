import { Header } from "../app/Header";

export function ReviewPage({ driveId }: { driveId: number }) {
  return <Header>{driveId}</Header>;
}
