// A hand that pulls bodies while the scene runs: where the pointer presses on one, a spring draws it to the pointer.
import { useEffect, useRef, useState, type RefObject } from "react";
import { bodyOfMesh } from "../model/pull";
import { client, request, useStudio } from "../model/store";
import type { View } from "./view";

const kMoveMs = 40;

interface Hand {
  mesh: string;
  body: string;
  to: number[];
}

export function Grab({ view, stage }: { view: View; stage: RefObject<HTMLDivElement> }) {
  const [hand, setHand] = useState<Hand | null>(null);
  const line = useRef<SVGLineElement>(null);
  useEffect(() => {
    const element = stage.current!;
    let held: Hand | null = null, timer: ReturnType<typeof setTimeout> | undefined;
    const send = () => {
      timer = undefined;
      if (held) void client.ask("body.pull", { node: held.body, to: held.to }).catch(() => {});
    };
    const press = (e: PointerEvent) => {
      const { scene, types } = useStudio.getState();
      const hit = e.button === 0 && types ? view.meshAt(e.clientX, e.clientY, (mesh) => bodyOfMesh(scene, types, mesh) !== null) : null;
      if (!hit) return;
      // The camera stays.
      e.stopPropagation();
      element.setPointerCapture(e.pointerId);
      held = { mesh: hit.node, body: bodyOfMesh(scene, types!, hit.node)!, to: hit.center };
      setHand(held);
      void request("body.pull", { node: held.body, to: held.to });
    };
    const move = (e: PointerEvent) => {
      const to = held && view.besides(e.clientX, e.clientY, held.to);
      if (!held || !to) return;
      held = { ...held, to };
      setHand(held);
      timer ??= setTimeout(send, kMoveMs);
    };
    const release = () => {
      if (!held) return;
      clearTimeout(timer);
      timer = undefined;
      held = null;
      setHand(null);
      void client.ask("body.release").catch(() => {});
    };
    const all = { pointerdown: press, pointermove: move, pointerup: release, pointercancel: release } as const;
    for (const [type, f] of Object.entries(all)) element.addEventListener(type, f as EventListener, true);
    return () => {
      release();
      for (const [type, f] of Object.entries(all)) element.removeEventListener(type, f as EventListener, true);
    };
  }, [view, stage]);
  useEffect(() => {
    if (!hand) return;
    const place = () => {
      const from = view.project(view.centerOf(hand.mesh) ?? hand.to), to = view.project(hand.to);
      line.current?.toggleAttribute("hidden", !from || !to);
      if (from && to) for (const [name, v] of Object.entries({ x1: from.x, y1: from.y, x2: to.x, y2: to.y })) line.current?.setAttribute(name, String(v));
    };
    place();
    return view.onDrawn(place);
  }, [view, hand]);
  if (!hand) return null;
  return (
    <>
      <svg className="arrow pull" aria-hidden><line ref={line} /></svg>
      <p className="told over" role="status">Pulling {hand.body} to {hand.to.map((x) => x.toFixed(2)).join(", ")} m</p>
    </>
  );
}
