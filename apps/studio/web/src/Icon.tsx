// Signs that fonts do not have everywhere.

const kPaths = {
  play: "M2 1l9 5-9 5z",
  pause: "M2 1h3v10H2zM7 1h3v10H7z",
  reset: "M1 1h2v10H1zM11 1v10L4 6z",
  frame: "M9 1h2v10H9zM1 1v10l7-5z",
  modules: "M1 1h6v3H1zM3 5h6v3H3zM5 9h6v2H5z",
} as const;

export function Icon({ name }: { name: keyof typeof kPaths }) {
  return (
    <svg className="icon" viewBox="0 0 12 12" aria-hidden>
      <path d={kPaths[name]} />
    </svg>
  );
}
