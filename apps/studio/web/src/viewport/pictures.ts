// Asks for pictures by the server's renderer: one at a time, the next when one has come or the camera has moved.

export interface Camera {
  eye: number[];
  target: number[];
  fov: number;
}

export interface PictureSource {
  camera(): Camera;
  size(): { width: number; height: number };
  /** Whether what there is to see goes on by itself. */
  follows(): boolean;
  /** Resolves to whether a picture was drawn. */
  ask(fields: object): Promise<boolean>;
  /** The one that was drawn last is to be seen. */
  show(): void;
  failed(reason: unknown): void;
}

const kStillMs = 250;
const kRetryMs = 500;
const kMinPixels = 16;

export class PictureLoop {
  private running = true;
  /** What is being asked for: the present frame, or the next one, which may take long to come. */
  private waiting: "now" | "newer" | null = null;
  private dirty = false;
  private asked = 0;
  private retry: ReturnType<typeof setTimeout> | undefined;
  private moving = false;
  private still: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly source: PictureSource) {
    void this.request(false);
  }

  /** The camera has moved. Until it rests, pictures are small and quick. */
  moved(): void {
    this.moving = true;
    clearTimeout(this.still);
    this.still = setTimeout(() => ((this.moving = false), this.again()), kStillMs);
    this.again();
  }

  /** What there is to see has changed. */
  again(): void {
    if (!this.running) return;
    if (this.waiting === "now") this.dirty = true;
    else void this.request(false);
  }

  stop(): void {
    this.running = false;
    clearTimeout(this.still);
    clearTimeout(this.retry);
  }

  /** There is nothing to draw yet, as while a scene is reset. */
  private later(): void {
    this.waiting = null;
    this.retry = setTimeout(() => this.again(), kRetryMs);
  }

  private async request(newer: boolean): Promise<void> {
    const own = ++this.asked;
    this.waiting = newer ? "newer" : "now";
    this.dirty = false;
    const scale = this.moving ? 0.5 : 1;
    const { width, height } = this.source.size();
    const pixels = (n: number) => Math.max(kMinPixels, 2 * Math.round((scale * n) / 2));
    try {
      const drawn = await this.source.ask({
        ...this.source.camera(), width: pixels(width), height: pixels(height), samples: this.moving ? 1 : 2, newer,
      });
      if (!this.running || own !== this.asked) return;
      if (!drawn) return this.later();
      this.source.show();
    } catch (e) {
      if (!this.running || own !== this.asked) return;
      this.running = false;
      return this.source.failed(e);
    }
    if (this.dirty || this.source.follows()) return void this.request(!this.dirty);
    this.waiting = null;
  }
}
