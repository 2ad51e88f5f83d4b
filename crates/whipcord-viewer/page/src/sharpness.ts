// How finely the view is drawn. A machine that draws by its processor alone draws more coarsely while something moves,
// so that the picture follows, and finely once it rests.

/** Time in ms after which what has not moved rests. */
export const REST = 250;
/** Time in ms that a picture of what moves may take: beyond it the next ones are coarser, and finer ones are tried when it takes less than half. */
const SMOOTH = 10;
/** Pictures that a mean is taken over. */
const COUNTED = 3;
const COARSER = 0.8;
const COARSEST = 0.4;

/** Pixels of the picture for each of the page, along an edge. */
export class Sharpness {
  /** Of the display. */
  display: number;
  readonly #bySoftware: boolean;
  /** Of the usual one, while something moves. */
  #share = 1;
  #moves = false;
  #sum = 0;
  #count = 0;

  /** `bySoftware`: edges are not smoothed while something moves, and smoothed by more pixels when it rests. */
  constructor(display: number, bySoftware: boolean) {
    this.display = display;
    this.#bySoftware = bySoftware;
  }

  /** As the display has it: where all is drawn in time, and in films, whose pictures are all of one size. */
  get usual(): number {
    return Math.min(this.display, 2);
  }

  /** Where nothing moves. */
  get still(): number {
    this.#moves = false;
    return this.#bySoftware ? 2 : this.usual;
  }

  /** Where something moves. */
  get moving(): number {
    this.#moves = true;
    return this.#bySoftware ? this.#share * this.usual : this.usual;
  }

  /** A picture has been drawn in this time in ms. */
  took(time: number): void {
    if (!this.#bySoftware || !this.#moves) return;
    this.#sum += time;
    if (++this.#count < COUNTED) return;
    const mean = this.#sum / this.#count;
    if (mean > SMOOTH) this.#share = Math.max(this.#share * COARSER, COARSEST);
    else if (mean < SMOOTH / 2) this.#share = Math.min(this.#share / COARSER, 1);
    [this.#sum, this.#count] = [0, 0];
  }
}

/** Whether a browser draws without a graphics card. */
export function drawsBySoftware(): boolean {
  known ??= isSoftware();
  return known;
}

let known: boolean | undefined;

function isSoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const card = context?.getExtension("WEBGL_debug_renderer_info");
  const name = card ? String(context?.getParameter(card.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
