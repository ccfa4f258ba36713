// Scenes that show what a type does.
import type { Template } from "../protocol/client";

const kMost = 4;

/** Scenes to start from with a type in them, the smallest first. */
export const examplesOf = (type: string, all: Template[]): Template[] =>
  all.filter((t) => t.types.includes(type)).sort((a, b) => a.types.length - b.types.length).slice(0, kMost);
