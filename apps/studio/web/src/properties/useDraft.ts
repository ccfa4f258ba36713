// What is typed into a field.
import { useState } from "react";
import { useStudio } from "../model/store";

/** A text until it is taken, and why it was refused. Both begin anew with each value that the scene has, with each undo, and with the pen. */
export function useDraft(shown: string) {
  // What a window without the pen typed before it lost it is not what the scene has.
  const undone = useStudio((s) => `${s.undone} ${s.role}`);
  const [text, setText] = useState(shown);
  const [problem, setProblem] = useState<string | null>(null);
  const [from, setFrom] = useState({ shown, undone });
  if (from.shown !== shown || from.undone !== undone) {
    setFrom({ shown, undone });
    setText(shown);
    setProblem(null);
  }
  return { text, setText, problem, setProblem };
}
