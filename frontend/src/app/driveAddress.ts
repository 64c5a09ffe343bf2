/** The drive whose review a path is the address of; undefined where it is another page's. */
export function reviewedDrive(pathname: string): number | undefined {
  const id = /^\/drives\/(\d+)$/.exec(pathname)?.[1];
  return id === undefined ? undefined : Number(id);
}
