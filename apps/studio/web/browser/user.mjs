// A user whose every press is counted: all goes by the pointer and the keyboard of the page.
import { readFile } from "node:fs/promises";
import { basename } from "node:path";

/** `clicks` are presses of the pointer's button, a drag or a dropped file too; `keys` are chords; `texts` are what is typed, of `letters`. */
const nothing = () => ({ clicks: 0, keys: 0, texts: 0, letters: 0 });

const kSteps = 6;

export class User {
  constructor(page) {
    this.page = page;
    this.did = nothing();
  }

  /** What was done since it was asked the last time. */
  told() {
    const { did } = this;
    this.did = nothing();
    return did;
  }

  async click(what, options) {
    ++this.did.clicks;
    await what.click(options);
  }

  async clickAt({ x, y }) {
    ++this.did.clicks;
    await this.page.mouse.click(x, y);
  }

  async press(...keys) {
    for (const key of keys) {
      ++this.did.keys;
      await this.page.keyboard.press(key);
    }
  }

  /** Types where the keyboard is. */
  async write(text) {
    ++this.did.texts;
    this.did.letters += String(text).length;
    await this.page.keyboard.type(String(text));
  }

  /** A click selects what a number holds, so that it is typed over. */
  async fill(field, text) {
    await this.click(field);
    await this.write(text);
    await this.press("Enter");
  }

  /** Opens a list of choices and takes one. */
  async choose(list, value) {
    this.did.clicks += 2;
    await list.selectOption(value);
  }

  async drag(from, to) {
    ++this.did.clicks;
    const { mouse } = this.page;
    await mouse.move(from.x, from.y);
    await mouse.down();
    await mouse.move(to.x, to.y, { steps: kSteps });
    await mouse.up();
  }

  /** Drags a file from the desktop, and lets it go over a part of the page. */
  async drop(path, onto) {
    ++this.did.clicks;
    const files = await this.page.evaluateHandle(([name, data]) => {
      const all = new DataTransfer();
      all.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], name));
      return all;
    }, [basename(path), (await readFile(path)).toString("base64")]);
    await this.page.dispatchEvent(onto, "drop", { dataTransfer: files });
  }
}
