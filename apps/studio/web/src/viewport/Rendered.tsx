// The picture that the server draws, above the view whose camera it has: of the run, or of the recorded frame that is looked at.
import { useEffect, useRef, useState } from "react";
import { client, say, useStudio, viewers } from "../model/store";
import { Refusal } from "../protocol/client";
import type { PicturePacket } from "../protocol/packets";
import { PictureLoop } from "./pictures";
import type { View } from "./view";

const kMaxWidth = 1920;

/** `onUnkept`: why recorded frames cannot be drawn; `onFailed`: nothing can. */
export function Rendered({ view, onFailed, onUnkept }: { view: View; onFailed(): void; onUnkept(why: string): void }) {
  const image = useRef<HTMLImageElement>(null);
  const render = useStudio((s) => s.scene["render"]);
  const looking = useStudio((s) => s.looking);
  const loop = useRef<PictureLoop | null>(null);
  const [shown, setShown] = useState<{ frame: number; time: number; asked: number | null } | null>(null);
  useEffect(() => {
    const box = image.current!.parentElement!;
    let address = "", come: PicturePacket | null = null, asked: number | null = null;
    viewers.picture = (p) => (come = p);
    const past = () => useStudio.getState().looking;
    const made = new PictureLoop({
      camera: () => view.pose(),
      size: () => {
        const scale = Math.min(devicePixelRatio, kMaxWidth / box.clientWidth);
        return { width: scale * box.clientWidth, height: scale * box.clientHeight };
      },
      follows: () => past() === null,
      ask: async (fields) => {
        const frame = (asked = past());
        try {
          return (await client.ask<{ drawn: boolean }>("picture", { ...fields, ...(frame !== null && { frame, newer: false }) })).drawn;
        } catch (e) {
          if (frame === null || !(e instanceof Refusal)) throw e;
          onUnkept(e.problem.message);
          return false;
        }
      },
      show: () => {
        if (!come) return;
        const { frame, time } = come;
        URL.revokeObjectURL(address);
        address = URL.createObjectURL(new Blob([come.data], { type: come.type }));
        image.current!.src = address;
        setShown({ frame, time, asked });
        if (asked !== null) useStudio.setState({ shown: { frame, time } });
      },
      failed: (e) => (say(e), onFailed()),
    });
    loop.current = made;
    const leave = view.onCamera(() => made.moved());
    const sizes = new ResizeObserver(() => made.again());
    sizes.observe(box);
    void client.ask("stream.set", { particles: false }).catch(say);
    return () => {
      made.stop();
      leave();
      sizes.disconnect();
      viewers.picture = () => {};
      URL.revokeObjectURL(address);
      void client.ask("stream.set", { particles: true }).catch(say);
    };
  }, [view, onFailed, onUnkept]);
  useEffect(() => loop.current?.again(), [render, looking]);
  return (
    <>
      <img ref={image} className="rendered" alt="The simulation as the videos show it" />
      {looking !== null && shown && (
        <p className="told over" role="status" data-frame={shown.frame} data-asked={shown.asked}>
          Frame {shown.frame}, {shown.time.toFixed(3)} s
          {shown.asked === looking ? shown.frame !== looking && `: the nearest to frame ${looking} that is kept whole` : `; drawing frame ${looking}…`}
        </p>
      )}
    </>
  );
}
