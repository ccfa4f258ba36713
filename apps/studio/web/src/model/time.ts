// Durations as badges and tables show them.

const kMinMs = 0.01;

/** "4.4 ms"; what is too short to matter is "< 0.01 ms". */
export const msText = (ms: number): string => `${ms < kMinMs ? `< ${kMinMs}` : Number(ms.toPrecision(3)) < 10 ? ms.toPrecision(2) : ms.toFixed(0)} ms`;
