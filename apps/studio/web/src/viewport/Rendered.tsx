// The picture that the server draws, above the view whose camera it has.
import { useEffect, useRef } from "react";
import { client, say, useStudio, viewers } from "../model/store";
import { PictureLoop } from "./pictures";
import type { View } from "./view";

const kMaxWidth = 1920;

export function Rendered({ view, onFailed }: { view: View; onFailed(): void }) {
  const image = useRef<HTMLImageElement>(null);
  const render = useStudio((s) => s.scene["render"]);
  const loop = useRef<PictureLoop | null>(null);
  useEffect(() => {
    const box = image.current!.parentElement!;
    let shown = "";
    viewers.picture = (p) => {
      URL.revokeObjectURL(shown);
      shown = URL.createObjectURL(new Blob([p.data], { type: p.type }));
      image.current!.src = shown;
    };
    const made = new PictureLoop({
      camera: () => view.pose(),
      size: () => {
        const scale = Math.min(devicePixelRatio, kMaxWidth / box.clientWidth);
        return { width: scale * box.clientWidth, height: scale * box.clientHeight };
      },
      ask: async (fields) => (await client.ask<{ drawn: boolean }>("picture", fields)).drawn,
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
      URL.revokeObjectURL(shown);
      void client.ask("stream.set", { particles: true }).catch(say);
    };
  }, [view, onFailed]);
  useEffect(() => loop.current?.again(), [render]);
  return <img ref={image} className="rendered" alt="The simulation as the videos show it" />;
}
