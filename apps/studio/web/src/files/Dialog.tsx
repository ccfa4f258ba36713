// A box above the page; Escape and a click beside it close it, and the keyboard stays in it.
import { useEffect, useRef, type ReactNode } from "react";

const kReachable = "button:not(:disabled), input:not(:disabled), select:not(:disabled), textarea:not(:disabled), summary, [tabindex='0']";

export function Dialog({ title, className = "", beside, onClose, children }: {
  title: string; className?: string; onClose(): void; children: ReactNode;
  /** It lies beside what it is about, which is still seen and used. */
  beside?: boolean;
}) {
  const box = useRef<HTMLDivElement>(null);
  // The keyboard goes back to where it was.
  useEffect(() => {
    const before = document.activeElement as HTMLElement | null;
    const first = (which: string) => box.current!.querySelector<HTMLElement>(which);
    if (!box.current!.contains(before)) (first("[data-first]") ?? first(kReachable))?.focus();
    return () => before?.focus();
  }, []);
  const key = (e: React.KeyboardEvent) => {
    if (e.key === "Escape") return (e.stopPropagation(), onClose());
    if (e.key !== "Tab" || beside) return;
    const all = [...box.current!.querySelectorAll<HTMLElement>(kReachable)];
    const [from, to] = e.shiftKey ? [all[0], all.at(-1)] : [all.at(-1), all[0]];
    if (document.activeElement !== from) return;
    e.preventDefault();
    to?.focus();
  };
  return (
    <>
      {!beside && <div className="shade" onClick={onClose} />}
      <div ref={box} className={`dialog ${beside ? "beside" : ""} ${className}`} role="dialog" aria-modal={!beside} aria-label={title} onKeyDown={key}>{children}</div>
    </>
  );
}
