// How finely the view is drawn. A machine that draws by its processor alone draws more coarsely while something moves,
// so that the picture follows, and finely once it rests.

/** Time in ms after which what has not moved rests. */
export const REST = 250;
/** Longest mean time in ms from the wish for a picture to the picture that the eye takes for smooth. */
const SMOOTH = 21;
/** Pictures that a mean is taken over. */
const COUNTED = 6;
const COARSER = 0.8;
const COARSEST = 0.4;

/** Pixels of the picture for each of the page, along an edge. */
export class Sharpness {
  /** Of the display. */
  display: number;
  readonly #bySoftware: boolean;
  /** Of the usual one, while something moves. */
  #share = 1;
  #last = -Infinity;
  #late = 0;
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
    return this.#bySoftware ? 2 : this.usual;
  }

  /** Of a picture that was asked for and is drawn at these times in ms: coarser when the last ones were late. */
  moving(asked: number, drawn: number): number {
    if (!this.#bySoftware) return this.usual;
    const rested = asked - this.#last > REST;
    this.#last = drawn;
    if (rested) {
      // What made the last movement slow may be over.
      this.#share = Math.min(this.#share / COARSER, 1);
      [this.#late, this.#count] = [0, 0];
    }
    this.#late += drawn - asked;
    if (++this.#count === COUNTED) {
      if (this.#late > SMOOTH * COUNTED) this.#share = Math.max(this.#share * COARSER, COARSEST);
      [this.#late, this.#count] = [0, 0];
    }
    return this.#share * this.usual;
  }
}

/** Whether a browser draws without a graphics card. */
export function drawsBySoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const card = context?.getExtension("WEBGL_debug_renderer_info");
  const name = card ? String(context?.getParameter(card.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
