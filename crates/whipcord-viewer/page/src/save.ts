// What is taken out of the page: a picture, a body, a film.

import { Group, type Object3D } from "three";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";
import { STLExporter } from "three/addons/exporters/STLExporter.js";

import { element } from "./dom";
import type { Stage } from "./stage";

function download(name: string, content: Blob): void {
  const url = URL.createObjectURL(content);
  const link = element("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  // The browser has begun to read it by then.
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/** A copy of the robots inside a group of its own. */
function inside(robots: Object3D): Group {
  const group = new Group();
  group.add(robots.clone());
  return group;
}

async function png(stage: Stage, name: string): Promise<void> {
  stage.drawFinely();
  const picture = await new Promise<Blob | null>((done) => stage.canvas.toBlob(done, "image/png"));
  if (picture) download(`${name}.png`, picture);
}

/** glTF has metres, and y upwards. */
async function gltf(stage: Stage, name: string): Promise<void> {
  const body = inside(stage.shown);
  body.rotation.x = -Math.PI / 2;
  body.updateMatrixWorld(true);
  const content = await new GLTFExporter().parseAsync(body, { binary: true });
  download(`${name}.glb`, new Blob([content as ArrayBuffer], { type: "model/gltf-binary" }));
}

/** STL has no unit: programs take it for millimetres. */
function stl(stage: Stage, name: string): void {
  const body = inside(stage.shown);
  body.scale.setScalar(1e3);
  body.updateMatrixWorld(true);
  const content = new STLExporter().parse(body, { binary: true });
  download(`${name}.stl`, new Blob([content as unknown as BlobPart], { type: "model/stl" }));
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
  recorder.addEventListener("stop", () => (stage.filmed = false));
  stage.filmed = true;
  recorder.start(1000);
  return recorder;
}

/** Buttons for all of it; `name` is that of the files. */
export function saving(stage: Stage, name: () => string): HTMLElement {
  const button = (label: string, title: string, act: () => void): HTMLButtonElement =>
    element("button", { type: "button", title, onclick: act }, label);
  return element(
    "details",
    { id: "save" },
    element("summary", {}, "Save"),
    element(
      "div",
      {},
      button("Picture (PNG)", "The view as it is", () => void png(stage, name())),
      button("Robot (glTF)", "In metres, with colours", () => void gltf(stage, name())),
      button("Robot (STL)", "In millimetres", () => stl(stage, name())),
      new Film(stage, name).button,
    ),
  );
}
