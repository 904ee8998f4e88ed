// How a canvas begins: as fine as the screen, drawn at most once a frame, and anew when its size changes.

export interface Size {
  width: number;
  height: number;
  /** Device pixels a CSS pixel. */
  ratio: number;
}

/** Out of sight it has the size that it had in sight. */
const sizeOf = (canvas: HTMLCanvasElement): Size => {
  const ratio = window.devicePixelRatio || 1;
  const seen = canvas.clientWidth > 0 && canvas.clientHeight > 0;
  return { width: seen ? canvas.clientWidth : canvas.width / ratio, height: seen ? canvas.clientHeight : canvas.height / ratio, ratio };
};

export class Surface {
  private waiting = false;

  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly draw: (size: Size) => void,
  ) {
    new ResizeObserver(() => canvas.clientWidth > 0 && canvas.clientHeight > 0 && this.resized()).observe(canvas);
  }

  get size(): Size {
    return sizeOf(this.canvas);
  }

  redraw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.now();
    });
  }

  protected resized(): void {
    this.redraw();
  }

  protected now(): void {
    if (this.canvas.clientWidth > 0 && this.canvas.clientHeight > 0) this.draw(this.size);
  }
}

/** A surface with a pen, whose unit is the CSS pixel. */
export class FlatSurface extends Surface {
  readonly context: CanvasRenderingContext2D;

  constructor(
    canvas: HTMLCanvasElement,
    draw: (size: Size) => void,
    private readonly onResize: () => void,
  ) {
    super(canvas, (size) => {
      this.context.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
      this.context.clearRect(0, 0, size.width, size.height);
      draw(size);
    });
    const context = canvas.getContext("2d");
    if (!context) throw new Error("this browser draws no canvas");
    this.context = context;
  }

  protected override resized(): void {
    const { width, height, ratio } = this.size;
    const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width === across && this.canvas.height === down) return;
    this.canvas.width = across;
    this.canvas.height = down;
    this.onResize();
    // At once: a resized canvas is empty.
    this.now();
  }
}

/** A colour of the page's theme. */
export const token = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
