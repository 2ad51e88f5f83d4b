// What is taken out of the page: a picture, a body, a film.

import { Group, type Object3D } from "three";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";
import { STLExporter } from "three/addons/exporters/STLExporter.js";

import { element } from "./dom";
import { stamp, type Legend } from "./legend";
import type { Stage } from "./stage";

/** What there is to save. */
export interface Saved {
  /** Of the files, without what says their kind. */
  name(): string;
  /** The robots whose shapes are answers. */
  robots(): Object3D[];
  /** What their colours stand for, and the colour to write that in. */
  legend(): { legend: Legend; ink: string } | undefined;
  /** Something could not be saved, and why. */
  failed(message: string | undefined): void;
}

function download(name: string, content: Blob): void {
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
  return group;
}

/** The view, with what its colours stand for. */
async function png(stage: Stage, saved: Saved): Promise<void> {
  stage.drawFinely();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [stage.canvas.width, stage.canvas.height];
  const context = canvas.getContext("2d");
  if (!context) throw new Error("this browser draws no pictures");
  context.drawImage(stage.canvas, 0, 0);
  const said = saved.legend();
  if (said) stamp(context, said.legend, canvas.width / stage.canvas.clientWidth, said.ink);
  const picture = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
  if (!picture) throw new Error("this browser makes no PNG of it");
  download(`${saved.name()}.png`, picture);
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

/** A film of what the view shows, from one press of the button to the next. */
class Film {
  readonly button: HTMLButtonElement;
  #recorder: MediaRecorder | undefined;

  constructor(stage: Stage, name: () => string) {
    this.button = element("button", { type: "button", "aria-pressed": "false" }, "Record film");
    const type = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find(
      (one) => "MediaRecorder" in window && MediaRecorder.isTypeSupported(one),
    );
    this.button.disabled = type === undefined;
    this.button.title = type === undefined ? "This browser records no WebM" : "From now until the next press, as WebM";
    this.button.addEventListener("click", () => {
      if (this.#recorder) {
        this.#recorder.stop();
        this.#recorder = undefined;
      } else if (type !== undefined) {
        this.#recorder = film(stage, type, name());
      }
      const running = this.#recorder !== undefined;
      this.button.textContent = running ? "Stop film" : "Record film";
      this.button.setAttribute("aria-pressed", String(running));
    });
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
export function saving(stage: Stage, saved: Saved): HTMLElement {
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
  return element(
    "details",
    { id: "save" },
    element("summary", {}, "Save"),
    element(
      "div",
      {},
      button("Picture (PNG)", "The view as it is", () => png(stage, saved)),
      button("Robot (glTF)", "In metres, with colours", () => gltf(saved)),
      button("Robot (STL)", "In millimetres", () => stl(saved)),
      new Film(stage, () => saved.name()).button,
    ),
  );
}
