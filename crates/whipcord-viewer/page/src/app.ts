// The page: what the user does becomes a state, a state a request, an answer a picture.

import { modelColour } from "./colours";
import { describe as describeCloud, points } from "./cloud";
import { ellipsoid } from "./ellipsoid";
import { Controls } from "./controls";
import { byId, element } from "./dom";
import { add, conjugate, rotate, scale, tipFrame } from "./geometry";
import { key, show, type Legend } from "./legend";
import { paints } from "./paint";
import type { Answer, Cloud, Frame, Quaternion, Scene, Solved, Vector } from "./protocol";
import { readout } from "./readout";
import { RobotMesh } from "./robot";
import { describe, Recorded, recordingInPage, type Recording } from "./recorded";
import { saving } from "./save";
import { Live, type Listener, type Source } from "./source";
import { gridSpacing, MEASURED, Stage } from "./stage";
import { fromHash, History, initialState, rebase, same, toHash, toRequest, viewFromHash, viewToHash, type State } from "./state";
import { Theme } from "./theme";
import { MILLIMETRE, significant, toUnit } from "./units";

/** A model's robot, and the last shape that it had. */
interface Shown {
  mesh: RobotMesh;
  solved: Solved;
}

/** How much nearer a press of + goes. */
const ZOOM = 1.15;

/** Time in ms between two states of the numbers: faster than that nobody reads. */
const READABLE = 100;

/** How long an answer may take before the page says that it is waited for, in ms. */
const PATIENCE = 400;

export class App {
  readonly #stage: Stage;
  readonly #theme: Theme;
  readonly #source: Source;
  readonly #recording: Recording | undefined;
  readonly #undo: HTMLButtonElement;
  readonly #redo: HTMLButtonElement;
  #scene: Scene | undefined;
  #state: State | undefined;
  #initial: State | undefined;
  #history: History | undefined;
  #controls: Controls | undefined;
  #shown = new Map<string, Shown>();
  #answers: readonly Answer[] = [];
  #asked = 0;
  /** Requests up to this one were of an earlier version of the file. */
  #outdated = 0;
  #scheduled = false;
  #patience = 0;
  #reading = 0;
  #readAt = -Infinity;
  #frame: Frame | undefined;
  #broken: string | undefined;
  #error: string | undefined;
  #failure: string | undefined;
  #legend: Legend | undefined;
  /** Number of the answer that is shown, and what waits for that to the latest request. */
  #drawn = 0;
  #whenShown: (() => void) | undefined;
  /** Whether the user looks from elsewhere than the page did. */
  #looks = false;
  #connected = false;
  /** Force at the tip when it was taken hold of, in the world. */
  #held: Vector | undefined;
  /** Where the tip is dragged to. */
  #target: Vector | undefined;
  /** Whether the tip has been let go, but the answer to the last place is still waited for. */
  #letGo = false;
  /** What the latest survey was asked for, and its number. */
  #surveyed = "";
  #survey = 0;

  constructor() {
    const button = (label: string, keys: string, act: () => void): HTMLButtonElement =>
      element("button", { type: "button", title: keys === "" ? label : `${label} (${keys})`, onclick: act }, label);
    this.#undo = button("Undo", "Ctrl+Z", () => this.#back());
    this.#redo = button("Redo", "Ctrl+Shift+Z", () => this.#forth());
    this.#theme = new Theme(() => this.#redress());
    byId("actions").append(
      this.#undo,
      this.#redo,
      button("Reset", "", () => this.#reset()),
      button("Whole robot", "Home", () => this.#whole()),
      this.#theme.button,
    );
    this.#stage = new Stage(byId("canvas") as HTMLCanvasElement, {
      pull: (by, to) => this.#pull(by, to),
      release: () => {
        this.#held = undefined;
        if (this.#target) this.#letGo = true;
        else this.#commit();
        this.#settle();
      },
      looked: () => {
        this.#looks = true;
        this.#writeAddress();
      },
    });
    byId("actions").append(
      saving(this.#stage, {
        name: () => this.#scene?.file.replace(/\.toml$/, "") ?? "robot",
        robots: () => [...this.#shown.values()].filter(({ mesh }) => !mesh.stale).map(({ mesh }) => mesh.group),
        legend: () => this.#legend && { legend: this.#legend, ink: this.#theme.colours.ink },
        failed: (message) => {
          this.#failure = message;
          this.#tell();
        },
      }),
    );
    window.addEventListener("keydown", (event) => this.#key(event));
    window.addEventListener("hashchange", () => this.#address());
    const listener: Listener = {
      scene: (scene) => this.#open(scene),
      frame: (frame) => this.#receive(frame),
      cloud: (cloud) => this.#cloud(cloud),
      noCloud: (id, message) => {
        if (id === this.#survey) this.#tellOfCloud(message);
      },
      broken: (message) => {
        this.#broken = message;
        this.#tell();
      },
      connected: (yes) => {
        this.#connected = yes;
        if (!yes) this.#wait(false);
        this.#tell();
      },
      error: (message) => {
        this.#error = message;
        this.#wait(false);
        this.#tell();
      },
    };
    this.#recording = recordingInPage();
    if (this.#recording) {
      this.#source = new Recorded(this.#recording, listener);
    } else {
      const url = new URL("/socket", location.href);
      url.protocol = url.protocol.replace("http", "ws");
      this.#source = new Live(url.href, listener);
    }
  }

  #open(scene: Scene): void {
    this.#broken = undefined;
    // What the user has moved stays as it is when the file is read again, and so does what undo goes back to.
    const focused = document.activeElement;
    const [before, initial] = [this.#scene, this.#initial];
    const fits = initial !== undefined && JSON.stringify(before?.sliders) === JSON.stringify(scene.sliders);
    const again = fits ? (state: State): State => rebase(state, initial, scene) : undefined;
    if (again && this.#state && this.#history) {
      this.#state = again(this.#state);
      this.#history.rebase(again);
    } else {
      this.#state = fromHash(location.hash, scene);
      this.#history = new History(this.#state);
    }
    this.#scene = scene;
    this.#initial = initialState(scene);
    // A page that was exported with a cloud shows it from the start.
    if (this.#recording?.cloud) this.#state.workspace = this.#initial.workspace = true;
    this.#outdated = this.#asked;
    this.#frame = undefined;
    [this.#target, this.#letGo, this.#surveyed] = [undefined, false, ""];
    this.#stage.target(undefined);
    this.#stage.cloud(undefined);
    this.#whenShown = undefined;
    this.#stage.robots([]);
    for (const { mesh } of this.#shown.values()) mesh.dispose();
    this.#shown.clear();
    this.#answers = [];
    byId("title").textContent = scene.title;
    byId("file").textContent = `${scene.file} · whipcord ${scene.version}`;
    document.title = `${scene.title} – Whipcord`;
    this.#controls = new Controls(
      scene,
      byId("controls"),
      {
        change: (edit) => this.#change(edit),
        commit: () => this.#commit(),
        whenShown: (cable, act) => {
          this.#whenShown = () => act(this.#first?.cables[cable]);
          this.#catchUp();
        },
      },
      modelColour,
      this.#recording?.axes,
      !this.#recording || this.#recording.cloud !== undefined,
    );
    if (this.#recording) {
      byId("note").textContent = describe(this.#recording);
      byId("note").hidden = false;
    }
    const looksAnew = this.#stage.surround(scene, this.#theme.colours);
    if (!before) this.#lookFrom(location.hash);
    else if (looksAnew) this.#looks = false;
    if (again) this.#writeAddress();
    refocus(focused);
    const spacing = significant(toUnit(gridSpacing(scene), MILLIMETRE), 3);
    const measured = scene.measured.length > 0 ? [key({ colour: MEASURED, label: "measured on the real robot" })] : [];
    byId("scale").replaceChildren(`grid ${spacing} mm`, ...measured);
    if (!this.#recording || this.#recording.cloud) this.#ensureCloud(this.#state);
    this.#show();
  }

  #change(edit: (state: State) => void): void {
    if (!this.#state || !this.#scene) return;
    const { colouring } = this.#state;
    edit(this.#state);
    this.#controls?.limits(null);
    // A matter of the page alone.
    if (this.#state.colouring !== colouring) this.#dress(this.#scene, this.#state);
    else this.#show();
  }

  /** Asks where the tip can go, if that is to be shown and is not known for these loads. */
  #ensureCloud(state: State): void {
    const kinds = state.commands.map((command) => Object.keys(command)[0]);
    const { tipForce, tipMoment, gravity, models } = state;
    const wanted = state.workspace ? JSON.stringify([tipForce, tipMoment, gravity, models[0], kinds]) : "";
    if (wanted === this.#surveyed) return;
    const ended = this.#surveyed !== "";
    this.#surveyed = wanted;
    this.#stage.cloud(undefined);
    if (wanted !== "") {
      this.#source.survey(toRequest(state, ++this.#survey));
      this.#tellOfCloud("Surveying…");
    } else if (ended) {
      this.#source.survey(undefined);
      this.#tellOfCloud("");
    }
  }

  #cloud(cloud: Cloud): void {
    if (cloud.id !== this.#survey || this.#surveyed === "") return;
    this.#stage.cloud(points(cloud));
    this.#tellOfCloud(describeCloud(cloud));
  }

  #tellOfCloud(words: string): void {
    const hint = document.getElementById("cloud");
    if (!hint) return;
    hint.textContent = words;
    hint.hidden = words === "";
  }

  #commit(): void {
    if (!this.#state || !this.#initial) return;
    this.#history?.commit(this.#state);
    this.#ensureCloud(this.#state);
    this.#failure = undefined;
    this.#writeAddress();
    this.#buttons();
  }

  #writeAddress(): void {
    if (!this.#state || !this.#initial) return;
    const parts = [toHash(this.#state, this.#initial), this.#looks ? viewToHash(this.#stage.view) : ""];
    const hash = parts.filter((part) => part !== "").join("&");
    history.replaceState(null, "", hash === "" ? location.pathname + location.search : `#${hash}`);
  }

  #lookFrom(hash: string): void {
    const view = viewFromHash(hash);
    this.#looks = view !== undefined;
    if (view) this.#stage.view = view;
    else if (this.#scene) this.#stage.lookAtBase(this.#scene);
  }

  #whole(): void {
    if (!this.#scene) return;
    const shapes = [...this.#shown.values()].flatMap(({ solved }) => solved.positions);
    this.#stage.look(this.#scene, [this.#scene.base.position, ...shapes]);
    this.#looks = false;
    this.#writeAddress();
  }

  #set(state: State | undefined): void {
    if (!state) return;
    this.#state = state;
    [this.#target, this.#letGo] = [undefined, false];
    this.#stage.target(undefined);
    this.#controls?.limits(null);
    this.#show(true);
    this.#commit();
  }

  #back(): void {
    this.#set(this.#history?.undo());
  }

  #forth(): void {
    this.#set(this.#history?.redo());
  }

  #reset(): void {
    this.#set(this.#initial && structuredClone(this.#initial));
  }

  #address(): void {
    if (!this.#scene || !this.#state) return;
    const { hash } = location;
    this.#lookFrom(hash);
    const state = fromHash(hash, this.#scene);
    if (!same(state, this.#state)) this.#set(state);
  }

  #key(event: KeyboardEvent): void {
    const control = event.ctrlKey || event.metaKey;
    const key = event.key.toLowerCase();
    if (control && key === "z") {
      event.preventDefault();
      if (event.shiftKey) this.#forth();
      else this.#back();
    } else if (control && key === "y") {
      event.preventDefault();
      this.#forth();
    } else if (event.target === this.#stage.canvas && !control) {
      if (key === "home") this.#whole();
      if (key === "+" || key === "=") this.#stage.zoom(ZOOM);
      if (key === "-") this.#stage.zoom(1 / ZOOM);
    }
  }

  /** The force that drags the tip grows with the distance: half the robot's length is the end of the slider. Or commands are
   * sought for the place. */
  #pull(by: Vector, to: Vector): void {
    const [scene, state] = [this.#scene, this.#state];
    if (!scene || !state) return;
    if (state.dragging === "reach") {
      [this.#target, this.#letGo] = [to, false];
      this.#stage.target(to);
      return this.#show();
    }
    const frame = this.#tipFrame(scene);
    this.#held ??= rotate(frame, state.tipForce);
    const force = add(this.#held, scale(by, (2 * scene.ranges.force) / scene.length));
    const own = rotate(conjugate(frame), force);
    // In steps that can be read.
    const step = 10 ** Math.floor(Math.log10(scene.ranges.force) - 2.5);
    state.tipForce = own.map((f) => Number((Math.round(f / step) * step).toPrecision(6))) as Vector;
    this.#show();
  }

  /** The robot whose tip has the handle: the first that has a shape. */
  get #first(): Solved | undefined {
    const solved = this.#answers.find((answer) => answer.status === "solved");
    return solved ?? [...this.#shown.values()][0]?.solved;
  }

  #tipFrame(scene: Scene): Quaternion {
    return tipFrame(scene, this.#first?.orientations.at(-1) ?? scene.base.orientation);
  }

  /** Shows what the state says, and asks for the robot's shape: once for each picture of the display. */
  #show(anew = false): void {
    const [scene, state] = [this.#scene, this.#state];
    if (!scene || !state) return;
    this.#controls?.show(state, anew);
    this.#buttons();
    if (this.#scheduled) return;
    this.#scheduled = true;
    requestAnimationFrame(() => {
      this.#scheduled = false;
      if (!this.#state) return;
      this.#source.ask(toRequest(this.#state, ++this.#asked, this.#target ?? null));
      // Most answers come at once; who waits is told that it goes on.
      if (this.#connected) this.#patience ||= window.setTimeout(() => this.#wait(true), PATIENCE);
    });
  }

  #buttons(): void {
    this.#undo.disabled = !this.#history?.canUndo;
    this.#redo.disabled = !this.#history?.canRedo;
  }

  /** Answers may come faster than the display shows them. */
  #receive(frame: Frame): void {
    if (frame.id <= this.#outdated) return;
    this.#error = undefined;
    // A newer request may still be waited for, which then waits from now on.
    this.#wait(false);
    if (frame.id < this.#asked) this.#patience = window.setTimeout(() => this.#wait(true), PATIENCE);
    const waiting = this.#frame !== undefined;
    this.#frame = frame;
    if (waiting) return;
    requestAnimationFrame(() => {
      const latest = this.#frame;
      this.#frame = undefined;
      if (latest) this.#draw(latest);
    });
  }

  #draw(frame: Frame): void {
    const [scene, state] = [this.#scene, this.#state];
    if (!scene || !state) return;
    this.#answers = frame.answers;
    if (frame.reach && this.#target) {
      this.#controls?.limits(frame.reach);
      if (frame.reach.status === "found") {
        state.commands = frame.reach.commands;
        this.#controls?.show(state, false);
      }
    }
    byId("view").dataset["frame"] = String(frame.id);
    this.#dress(scene, state);
    this.#reading ||= window.setTimeout(() => this.#read(), READABLE - (performance.now() - this.#readAt));
    this.#tell();
    this.#drawn = frame.id;
    this.#settle();
    this.#catchUp();
  }

  /** Ends dragging once the answer to the last place is there. */
  #settle(): void {
    if (!this.#letGo || this.#drawn !== this.#asked || this.#scheduled) return;
    [this.#target, this.#letGo] = [undefined, false];
    this.#stage.target(undefined);
    this.#commit();
  }

  /** Does what waits for the answer to the latest request, if that is what is shown. */
  #catchUp(): void {
    if (this.#drawn !== this.#asked || this.#scheduled) return;
    const act = this.#whenShown;
    this.#whenShown = undefined;
    act?.();
  }

  /** Writes the numbers of the latest answers. */
  #read(): void {
    this.#reading = 0;
    this.#readAt = performance.now();
    const scene = this.#scene;
    if (scene) byId("answers").replaceChildren(...readout(scene, this.#answers, modelColour));
  }

  /** Robots in the shapes of the answers; one without an answer keeps its last shape, in grey. */
  #dress(scene: Scene, state: State): void {
    const solved = this.#answers.filter((answer) => answer.status === "solved");
    const asked = this.#answers.map((answer) => answer.model);
    for (const [model, { mesh }] of this.#shown) {
      if (asked.includes(model)) continue;
      mesh.dispose();
      this.#shown.delete(model);
    }
    const { paints: colours, legend } = paints(scene, solved, state.colouring);
    solved.forEach((answer, i) => {
      const shown = this.#shown.get(answer.model) ?? { mesh: new RobotMesh(scene, answer.model), solved: answer };
      shown.solved = answer;
      shown.mesh.update(answer, colours[i]!);
      this.#shown.set(answer.model, shown);
    });
    for (const [model, { mesh }] of this.#shown) {
      mesh.stale = !solved.some((answer) => answer.model === model);
    }
    this.#stage.robots([...this.#shown.values()].map(({ mesh }) => mesh.group));
    this.#stage.contacts(solved.flatMap((answer) => answer.contacts));
    this.#stage.objects(solved[0]?.objects ?? []);
    const yields = solved.flatMap(({ compliance }) => (compliance?.status === "known" ? compliance.values : []));
    const bodies = solved.map(({ compliance, positions, model }) =>
      compliance ? ellipsoid(compliance, Math.max(...yields), positions.at(-1)!, scene, modelColour(model)) : undefined,
    );
    this.#stage.marks(bodies.filter((body) => body !== undefined));
    // What the frames of an exported page are loaded with does not change.
    const grip = this.#recording ? undefined : this.#first?.positions.at(-1);
    this.#stage.tip(grip, rotate(this.#tipFrame(scene), state.tipForce), (0.5 * scene.length) / scene.ranges.force);
    this.#stage.draw();
    this.#legend = legend;
    show(byId("legend"), legend);
  }

  #tell(): void {
    const failed = this.#answers.filter((answer) => answer.status === "failed");
    const lines = [
      ...(this.#connected ? [] : ["No connection to whipcord: is it still running?"]),
      ...[this.#broken, this.#error, this.#failure].filter((line) => line !== undefined),
      ...(this.#state?.models.length === 0 ? ["No model is chosen: tick one under Models."] : []),
      ...failed.map((answer) =>
        this.#shown.has(answer.model)
          ? `${answer.model}: ${answer.message} (in grey: the last shape that it found)`
          : `${answer.model}: ${answer.message}`,
      ),
    ];
    const status = byId("status");
    const text = lines.join("\n");
    if (status.textContent !== text) status.textContent = text;
    status.hidden = text === "";
  }

  #wait(yes: boolean): void {
    window.clearTimeout(this.#patience);
    this.#patience = 0;
    byId("waiting").hidden = !yes;
  }

  #redress(): void {
    if (!this.#scene || !this.#state) return;
    this.#stage.surround(this.#scene, this.#theme.colours);
    this.#dress(this.#scene, this.#state);
  }
}

/** Gives the keyboard's focus back to the control that had it before all were made anew. */
function refocus(before: Element | null): void {
  if (!before || before.isConnected) return;
  const name = before.getAttribute("data-name");
  const like =
    name !== null ? `input[type="${before.getAttribute("type")}"][data-name="${name}"]`
    : before.id !== "" ? `#${CSS.escape(before.id)}`
    : before.hasAttribute("data-cable") ? `[data-cable="${before.getAttribute("data-cable")}"]`
    : undefined;
  if (like !== undefined) document.querySelector<HTMLElement>(like)?.focus();
}
