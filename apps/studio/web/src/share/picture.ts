// What is seen as a PNG that carries its scene.
import { fileNameOf } from "../model/names";
import { sceneOfRun } from "../model/recorded";
import { say } from "../model/store";
import { mainView } from "../viewport/view";
import { withScene } from "./carried";
import { save } from "./download";

/** The picture that the server has drawn where it does, or else that of the view. */
function seen(): HTMLCanvasElement | null {
  const rendered = document.querySelector<HTMLImageElement>("img.rendered[src]");
  if (!rendered) return mainView.current?.picture() ?? null;
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [rendered.naturalWidth, rendered.naturalHeight];
  canvas.getContext("2d")!.drawImage(rendered, 0, 0);
  return canvas;
}

export async function savePicture(): Promise<void> {
  try {
    const scene = sceneOfRun();
    const canvas = seen();
    const png = canvas && (await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png")));
    if (!png) throw new Error("there is no picture to save");
    const bytes = withScene(new Uint8Array(await png.arrayBuffer()), JSON.stringify(scene));
    save(new Blob([bytes], { type: "image/png" }), `${fileNameOf(scene.title)}.png`);
  } catch (e) {
    say(e);
  }
}
