/** Which class each of the keys 1 to 9 stands for: always the same one on a drive. */

/** What drives on roads, the commonest first: models of many classes know much that is not there. */
const ON_ROADS = ["car", "truck", "bus", "motorcycle", "bicycle", "person", "train", "traffic light", "stop sign"];

export function keyedClasses(classNames: readonly string[]): readonly string[] {
  if (classNames.length <= 9) return classNames;
  const first = ON_ROADS.filter((name) => classNames.includes(name));
  return [...first, ...classNames.filter((name) => !first.includes(name))].slice(0, 9);
}

/** All classes, those with a key first. */
export function classChoices(classNames: readonly string[]): readonly string[] {
  const keyed = keyedClasses(classNames);
  return [...keyed, ...classNames.filter((name) => !keyed.includes(name)).sort()];
}
