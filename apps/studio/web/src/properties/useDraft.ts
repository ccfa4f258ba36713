// What is typed into a field.
import { useState } from "react";
import { useStudio } from "../model/store";

/** A text until it is taken, and why it was refused. Both begin anew with each value that the scene has, and with each undo. */
export function useDraft(shown: string) {
  const undone = useStudio((s) => s.undone);
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
