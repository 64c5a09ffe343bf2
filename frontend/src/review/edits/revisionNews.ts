/** Which of the revisions that the server tells are news to this page. */
export class RevisionNews {
  private told: number | null = null;

  /**
   * Is this newer than what was told before? At first, than the labels that are known. Not later: labels that are read
   * meanwhile may hold a revision before the server tells of it, and what somebody else did would go unsaid.
   */
  isNews(revision: number, known: number | null): boolean {
    const before = this.told ?? known ?? revision;
    this.told = Math.max(before, revision);
    return revision > before;
  }
}
