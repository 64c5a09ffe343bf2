/**
 * Colours of identities: stable, bright enough for a picture of a street, and told apart by most colour-blind eyes.
 *
 * The colours are Okabe and Ito's (https://jfly.uni-koeln.de/color/) made lighter where they would drown in a picture,
 * and some of Paul Tol's between them. A colour is never the only sign: the identity's number stands beside it.
 */

export const PALETTE = [
  "#56b4e9", // sky blue
  "#ffb000", // amber
  "#2fd39a", // bluish green
  "#ff7a45", // vermilion
  "#f0e442", // yellow
  "#e79ac4", // reddish purple
  "#8c9eff", // indigo, lightened
  "#bbcc33", // pear
  "#99ddff", // light cyan
  "#ee8866", // orange, light
  "#44d7e8", // cyan
  "#ffc2d1", // pink
] as const;

/** The colour of an identity: the same in every view and every session. Neighbouring ids get different colours. */
export function identityColour(identityId: number): string {
  // 5 and the palette's 12 share no factor, so 12 ids in a row take 12 colours, far ones first. Every further dozen
  // is shifted by one, so that ids 12 apart differ too.
  const dozen = Math.floor(identityId / PALETTE.length);
  const index = (((identityId * 5 + dozen) % PALETTE.length) + PALETTE.length) % PALETTE.length;
  return PALETTE[index] as string;
}
