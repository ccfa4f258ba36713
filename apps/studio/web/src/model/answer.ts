// What the server answers to a question that is asked again as the run goes on: at most twice a second, one at a time.
import { useEffect, useRef } from "react";
import { client, useStudio } from "./store";

const kEveryMs = 500;

export interface Question {
  do: string;
  [field: string]: unknown;
}

/** Calls back with each answer, or with what was refused. A null question asks nothing; a new one is asked at once. */
export function useAnswer<T>(question: Question | null, onAnswer: (answer: T) => void, onRefused: (why: Error) => void = () => {}): void {
  const status = useStudio((s) => s.status);
  const connected = useStudio((s) => s.connected);
  const text = JSON.stringify(question);
  const latest = useRef({ text, onAnswer, onRefused });
  latest.current = { text, onAnswer, onRefused };
  const asked = useRef({ text: "", at: 0, waiting: false, again: false });
  useEffect(() => {
    const a = asked.current;
    const ask = () => {
      if (a.waiting) return void (a.again = true);
      const { do: what, ...fields } = JSON.parse(latest.current.text) as Question;
      Object.assign(a, { text: latest.current.text, at: performance.now(), waiting: true });
      client.ask<T>(what, fields).then((answer) => a.text === latest.current.text && latest.current.onAnswer(answer), (e: Error) => a.text === latest.current.text && latest.current.onRefused(e)).finally(() => {
        a.waiting = false;
        if (!a.again) return;
        a.again = false;
        if (latest.current.text !== "null") ask();
      });
    };
    if (text === "null" || !connected) return;
    if (a.text !== text) return ask();
    const timer = setTimeout(ask, Math.max(0, a.at + kEveryMs - performance.now()));
    return () => clearTimeout(timer);
  }, [text, status, connected]);
}
