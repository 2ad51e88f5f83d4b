// What is taken out of the page: a picture, a body, a film.

import { Group, Mesh, type Object3D } from "three";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";
import { STLExporter } from "three/addons/exporters/STLExporter.js";

import { element } from "./dom";
import { picture, type PictureOptions, type Said } from "./picture";
import type { Stage } from "./stage";
import { standard, type Surface } from "./surface";

/** What there is to save. */
export interface Saved {
  /** Of the files, without what says their kind. */
  name(): string;
  /** The robots whose shapes are answers. */
  robots(): Object3D[];
  /** Takes a picture in the colours of paper: of what its colours stand for, and the colour to write that in. */
  onPaper<T>(take: (said: Said) => Promise<T>): Promise<T>;
  /** Something could not be saved, and why. */
  failed(message: string | undefined): void;
}

/** Gives a file to the user. */
export function download(name: string, content: Blob): void {
  const url = URL.createObjectURL(content);
  const link = element("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  // The browser has begun to read it by then.
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/** Copies of the robots inside a group of their own. */
function inside(robots: readonly Object3D[]): Group {
  if (robots.length === 0) throw new Error("no robot is shown whose shape is an answer");
  const group = new Group();
  group.add(...robots.map((robot) => robot.clone()));
  group.traverse((object) => {
    if (object instanceof Mesh) object.material = standard(object.material as Surface);
  });
  return group;
}

/** glTF has metres, and y upwards. */
async function gltf(saved: Saved): Promise<void> {
  const body = inside(saved.robots());
  body.rotation.x = -Math.PI / 2;
  body.updateMatrixWorld(true);
  const content = await new GLTFExporter().parseAsync(body, { binary: true });
  download(`${saved.name()}.glb`, new Blob([content as ArrayBuffer], { type: "model/gltf-binary" }));
}

/** STL has no unit: programs take it for millimetres. */
function stl(saved: Saved): void {
  const body = inside(saved.robots());
  body.scale.setScalar(1e3);
  body.updateMatrixWorld(true);
  const content = new STLExporter().parse(body, { binary: true });
  download(`${saved.name()}.stl`, new Blob([content as unknown as BlobPart], { type: "model/stl" }));
}

/** Pictures for each second of a film. */
const RATE = 30;

/** A film of what the view shows, from one press of the button to the next, or of a course that is played. */
export class Film {
  readonly button = element("button", { type: "button", "aria-pressed": "false" }, "Record film");
  readonly #stage: Stage;
  readonly #name: () => string;
  readonly #type: string | undefined;
  #recorder: MediaRecorder | undefined;

  constructor(stage: Stage, name: () => string) {
    [this.#stage, this.#name] = [stage, name];
    this.#type = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find(
      (one) => "MediaRecorder" in window && MediaRecorder.isTypeSupported(one),
    );
    this.button.disabled = !this.isPossible;
    this.button.title = this.isPossible ? "From now until the next press, as WebM" : "This browser records no WebM";
    this.button.addEventListener("click", () => this.record(this.#recorder === undefined));
  }

  get isPossible(): boolean {
    return this.#type !== undefined;
  }

  record(yes: boolean): void {
    if (yes === (this.#recorder !== undefined)) return;
    this.#recorder?.stop();
    this.#recorder = yes && this.#type !== undefined ? film(this.#stage, this.#type, this.#name()) : undefined;
    this.button.textContent = yes ? "Stop film" : "Record film";
    this.button.setAttribute("aria-pressed", String(yes));
  }
}

function film(stage: Stage, type: string, name: string): MediaRecorder {
  const recorder = new MediaRecorder(stage.canvas.captureStream(RATE), { mimeType: type, videoBitsPerSecond: 8e6 });
  const parts: Blob[] = [];
  recorder.addEventListener("dataavailable", (event) => parts.push(event.data));
  recorder.addEventListener("stop", () => download(`${name}.webm`, new Blob(parts, { type: "video/webm" })));
  recorder.addEventListener("stop", () => {
    stage.filmed = false;
    for (const track of recorder.stream.getTracks()) track.stop();
  });
  stage.filmed = true;
  recorder.start(1000);
  return recorder;
}

/** Buttons for all of it. */
export function saving(stage: Stage, saved: Saved, recorder: Film): HTMLElement {
  const button = (label: string, title: string, act: () => void | Promise<void>): HTMLButtonElement => {
    const attempt = async (): Promise<void> => {
      try {
        await act();
        saved.failed(undefined);
      } catch (error) {
        saved.failed(`${label} could not be saved: ${error instanceof Error ? error.message : String(error)}`);
      }
    };
    return element("button", { type: "button", title, onclick: () => void attempt() }, label);
  };
  const number = (id: string, label: string, value: number, least: number, most: number): [HTMLInputElement, HTMLElement] => {
    const box = element("input", { type: "number", id, value, min: least, max: most, step: "any" });
    return [box, element("div", { class: "choice" }, element("label", { for: id }, label), box)];
  };
  const check = (id: string, label: string, on: boolean): [HTMLInputElement, HTMLElement] => {
    const box = element("input", { type: "checkbox", id, checked: on });
    return [box, element("div", { class: "choice" }, box, element("label", { for: id }, label))];
  };
  const [width, widthRow] = number("picture-width", "Width in mm", 160, 10, 2000);
  const [height, heightRow] = number("picture-height", "Height in mm", 120, 10, 2000);
  const [resolution, resolutionRow] = number("picture-dpi", "DPI", 300, 30, 2400);
  const [transparent, transparentRow] = check("picture-transparent", "Transparent", false);
  const [labels, labelsRow] = check("picture-labels", "Labels and legend", true);
  const [bar, barRow] = check("picture-bar", "Scale bar", true);
  const [grid, gridRow] = check("picture-grid", "Grid", false);
  const take = async (format: PictureOptions["format"]): Promise<void> => {
    const options: PictureOptions = {
      format,
      width: Number(width.value),
      height: Number(height.value),
      resolution: Number(resolution.value),
      transparent: transparent.checked,
      labels: labels.checked,
      bar: bar.checked,
      grid: grid.checked,
    };
    download(`${saved.name()}.${format}`, await saved.onPaper((said) => picture(stage, options, said)));
  };
  return element(
    "details",
    { id: "save" },
    element("summary", {}, "Save"),
    element(
      "div",
      {},
      element("h2", {}, "Picture"),
      widthRow, heightRow, resolutionRow, transparentRow, labelsRow, barRow, gridRow,
      element("div", { class: "pair" },
        button("Picture (PNG)", "At this size and resolution, without handles", () => take("png")),
        button("Picture (SVG)", "Polygons and text at this size, without handles", () => take("svg")),
      ),
      element("h2", {}, "Robot"),
      element("div", { class: "pair" },
        button("Robot (glTF)", "In metres, with colours and the names of its parts", () => gltf(saved)),
        button("Robot (STL)", "In millimetres", () => stl(saved)),
      ),
      element("h2", {}, "Film"),
      recorder.button,
    ),
  );
}
