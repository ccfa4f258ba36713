// The keys of the graph.
import { useCallback, type KeyboardEvent, type RefObject } from "react";
import { useStudio } from "../model/store";
import { toggleModules } from "./NodeModules";
import {
  arrangeNodes, chosenNodes, copy, cut, duplicate, focusName, focusNote, focusProperties, fold, nudge, paste, remove, select, selectAll, selectNext, switchOff,
} from "./actions";

export interface Asked {
  add(x: number, y: number): void;
  link(): void;
  group(): void;
  fit(): void;
}

const kStep = 10;
const kLongStep = 50;

export function useKeys(pointer: RefObject<{ x: number; y: number }>, surface: RefObject<HTMLDivElement | null>, asked: Asked) {
  return useCallback((e: KeyboardEvent | globalThis.KeyboardEvent) => {
    if ((e.target as Element).closest("input, textarea, select, [contenteditable], [role=dialog]")) return;
    const { selected } = useStudio.getState();
    const nodes = chosenNodes(), one = selected.length === 1;
    const key = e.key.toLowerCase();
    const box = surface.current!.getBoundingClientRect();
    const { x, y } = pointer.current!, over = x >= box.left && x <= box.right && y >= box.top && y <= box.bottom;
    const at = over ? { x, y } : { x: box.left + box.width / 2, y: box.top + box.height / 2 };
    const step = e.shiftKey ? kLongStep : kStep;
    if (e.ctrlKey || e.metaKey) {
      if (key === "a") selectAll();
      else if (key === "c") copy();
      else if (key === "x") cut();
      else if (key === "v") paste();
      else if (key === "d") duplicate();
      else return;
    }
    // By Tab the keyboard goes on to what is selected, by Shift+Tab it leaves the graph.
    else if (key === "tab" && !e.shiftKey && selected.length > 0) focusProperties();
    else if ((key === "tab" && !e.shiftKey) || key === "a") asked.add(at.x, at.y);
    else if (key === "k" && nodes.length === 1) asked.link();
    else if (key === "delete" || key === "backspace") remove();
    else if (key === "c") fold();
    else if (key === "g") asked.group();
    else if ((key === "f2" || key === "enter") && one && nodes.length === 0) focusNote();
    else if (key === "f2" && one) focusName();
    else if (key === "pagedown") selectNext(1);
    else if (key === "pageup") selectNext(-1);
    else if (key === "escape") select([]);
    else if (key === "m") switchOff("muted");
    else if (key === "b") switchOff("bypassed");
    else if (key === "l") arrangeNodes();
    else if (key === "f") asked.fit();
    else if (key === "enter" && one) toggleModules(selected[0]!);
    else if (key === "arrowleft") nudge(-step, 0);
    else if (key === "arrowright") nudge(step, 0);
    else if (key === "arrowup") nudge(0, -step);
    else if (key === "arrowdown") nudge(0, step);
    else return;
    e.preventDefault();
    e.stopPropagation();
  }, [pointer, surface, asked]);
}
