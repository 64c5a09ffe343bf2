/** The address of a camera's picture in a frame; the original where no width is given. */
export function imageUrl(driveId: number, frame: number, camera: string, maxWidth?: number): string {
  const query = maxWidth ? `?max_width=${maxWidth}` : "";
  return `/api/drives/${driveId}/frames/${frame}/images/${encodeURIComponent(camera)}${query}`;
}
