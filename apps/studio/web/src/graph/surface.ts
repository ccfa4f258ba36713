// What the rest of the page asks of the graph; the graph puts itself here.
export const surface = {
  /** The middle of what is seen, in the graph's own units. */
  middle: (): { x: number; y: number } => ({ x: 0, y: 0 }),
  fit: (): void => {},
  /** Does what a key of the graph does. */
  key: (_: KeyboardEvent): void => {},
};
