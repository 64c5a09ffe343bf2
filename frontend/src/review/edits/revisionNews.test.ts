import { describe, expect, it } from "vitest";
import { RevisionNews } from "./revisionNews";

describe("news of the labels' revision", () => {
  it("is not what a page begins with", () => {
    expect(new RevisionNews().isNews(7, null)).toBe(false);
    expect(new RevisionNews().isNews(7, 7)).toBe(false);
  });

  it("is what came between the first labels and the first word of the server", () => {
    expect(new RevisionNews().isNews(8, 7)).toBe(true);
  });

  it("is told although labels that were read meanwhile have it already", () => {
    const news = new RevisionNews();
    news.isNews(7, 7);
    expect(news.isNews(8, 8)).toBe(true);
  });

  it("is told once, when the connection was lost as well", () => {
    const news = new RevisionNews();
    news.isNews(7, 7);
    expect(news.isNews(8, 7)).toBe(true);
    expect(news.isNews(8, 7)).toBe(false);
  });
});
