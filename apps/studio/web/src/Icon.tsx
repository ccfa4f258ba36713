// Signs that fonts do not have everywhere.

const kPaths = {
  play: "M2 1l9 5-9 5z",
  pause: "M2 1h3v10H2zM7 1h3v10H7z",
  reset: "M1 1h2v10H1zM11 1v10L4 6z",
  frame: "M9 1h2v10H9zM1 1v10l7-5z",
  undo: "M4 1L0.500 4.500 4 8V5.300h3.500a2.100 2.100 0 0 1 0 4.200H4V11h3.500a3.600 3.600 0 0 0 0-7.200H4z",
  redo: "M8 1l3.500 3.500L8 8V5.300H4.500a2.100 2.100 0 0 0 0 4.200H8V11H4.500a3.600 3.600 0 0 1 0-7.200H8z",
  moon: "M7.500 0.800A5.500 5.500 0 1 0 11.200 8 4.600 4.600 0 0 1 7.500 0.800z",
  sun: "M6 3.500a2.500 2.500 0 1 0 0 5 2.500 2.500 0 0 0 0-5zM5.400 0.300h1.200v1.900H5.400zM5.400 9.800h1.200v1.900H5.400zM0.300 5.400h1.900v1.200H0.300zM9.800 5.400h1.900v1.200H9.800z",
  find: "M5 0.800a4.200 4.200 0 1 0 2.400 7.700l2.900 2.900 1.100-1.100-2.900-2.900A4.200 4.200 0 0 0 5 0.800zM5 2.300a2.700 2.700 0 1 1 0 5.400 2.700 2.700 0 0 1 0-5.400z",
  back: "M10 1l-9 5 9 5z",
  first: "M1 1h2v10H1zM11 1v10L4 6z",
  last: "M9 1h2v10H9zM1 1v10l7-5z",
  branch: "M2 0.500h2V5h2.500V2.500L11 6 6.500 9.500V7H4v4.500H2z",
  camera: "M4 2.500L5 1h2l1 1.500h3v8H1v-8zM6 4a2.500 2.500 0 1 0 0 5 2.500 2.500 0 0 0 0-5zM6 5.300a1.200 1.200 0 1 1 0 2.400 1.200 1.200 0 0 1 0-2.400z",
  loop: "M6 1a5 5 0 1 0 5 5H9.4A3.4 3.4 0 1 1 6 2.6V5l4-3.2L6-1z",
  drop: "M6 0.5c2.4 3 3.9 4.9 3.9 6.9a3.9 3.9 0 0 1-7.8 0C2.1 5.400 3.600 3.500 6 0.5z",
  source: "M1 1h10v3H8v2H4V4H1zM4 7h1v2H4zM7 7h1v2H7zM5.500 9h1v2.500h-1z",
  solid: "M6 0.5l5 2.7v5.600L6 11.500 1 8.800V3.200z",
  mesh: "M6 0.500L11.500 11h-11zM6 3.400L3.300 9h5.400z",
  sink: "M1 1h10L7.500 6.500V11h-3V6.500z",
  surface: "M0.500 7.500C2.500 3 4.500 3 6 5.500S9.500 8 11.500 4v7h-11z",
  world: "M6 0.500a5.500 5.500 0 1 0 0 11 5.500 5.500 0 0 0 0-11zm0 2a3.500 3.500 0 1 1 0 7 3.500 3.500 0 0 1 0-7z",
  go: "M1 5h6V2l4.500 4L7 10V7H1z",
  warning: "M6 0.500l5.800 10.700H0.200zM5.300 4v4h1.400V4zm0 4.800v1.400h1.400V8.800z",
  folder: "M0.500 2h4l1.300 1.500h5.700V10.500h-11z",
  modules: "M1 1h6v3H1zM3 5h6v3H3zM5 9h6v2H5z",
} as const;

export type IconName = keyof typeof kPaths;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg className="icon" viewBox="0 0 12 12" aria-hidden>
      <path d={kPaths[name]} fillRule="evenodd" />
    </svg>
  );
}
