// The page: what the user does becomes a state, a state a request, an answer a picture. The parts do not know one another.

import { acting, loadsOf } from "./acting";
import { Beside } from "./beside";
import { modelColour } from "./colours";
import { describe as describeCloud, points } from "./cloud";
import { Connection } from "./connection";
import { Controls } from "./controls";
import { byId, element } from "./dom";
import { Designing } from "./designing";
import { Dragging } from "./dragging";
import { poseAt } from "./geometry";
import { Help } from "./help";
import { key, show, type Legend } from "./legend";
import { describe as describeErrors, errors, MEASURED } from "./measured";
import { Panel } from "./panel";
import type { Said } from "./picture";
import type { Acting, Answer, Cloud, Frame, Marker, Scene, Shown, Solved, Vector } from "./protocol";
import { describe, Recorded, recordingInPage, type Recording } from "./recorded";
import { ellipsoids, Robots, slackLabels } from "./robots";
import { Film, saving } from "./save";
import { scaleBar } from "./scale";
import { Live } from "./source";
import { gridSpacing, Stage } from "./stage";
import { viewFromHash, viewToHash, type State } from "./state";
import { Store } from "./store";
import { PAPER, Theme, type Colours } from "./theme";
import { Timeline, type Played } from "./timeline";
import { Toolbar } from "./toolbar";
import { MILLIMETRE, significant, toUnit } from "./units";

/** How much nearer a press of + goes. */
const ZOOM = 1.15;
/** Time in ms after the last change until the address has it. */
const SETTLED = 200;
/** Longest scale bar in pixels of the page. */
const BAR = 120;

export class App {
  readonly #stage: Stage;
  readonly #theme: Theme;
  readonly #store: Store;
  readonly #connection: Connection;
  readonly #dragging: Dragging;
  readonly #designing: Designing;
  readonly #robots = new Robots();
  readonly #beside = new Beside();
  readonly #panel: Panel;
  readonly #toolbar: Toolbar;
  readonly #timeline: Timeline;
  readonly #film: Film;
  readonly #help = new Help();
  readonly #recording: Recording | undefined = recordingInPage();
  readonly #undo: HTMLButtonElement;
  readonly #redo: HTMLButtonElement;
  #controls: Controls | undefined;
  /** What the sliders lead to, and what is shown: of a course that is played, another. */
  #live: readonly Answer[] = [];
  /** The latest shapes of a stream: of the robot of the file, and of those beside it. */
  #streamed: readonly Answer[] = [];
  #streamedOthers: readonly (Answer | null)[] = [];
  #answers: readonly Answer[] = [];
  /** Places of shapes that were played, which the view has room for. */
  readonly #played: Vector[] = [];
  /** What was measured where the shapes are that are shown; without it, in the last step. */
  #markers: readonly Marker[] | undefined;
  /** The loads at what is played, where they are known. */
  #acting: Acting | null = null;
  /** The state of the latest shape of the first model. */
  #solvable: State | undefined;
  #failure: string | undefined;
  #legend: Legend | undefined;
  /** Of words and loads in the view. */
  #ink = "";
  /** Of the arrows beside the robot. */
  #ends: readonly Vector[] = [];
  #whenShown: (() => void) | undefined;
  /** Whether the user looks from elsewhere than the page did, and whether the page is to look at the next shape. */
  #looks = false;
  #fits = false;
  #writing = 0;

  constructor() {
    const button = (label: string, keys: string, act: () => void): HTMLButtonElement =>
      element("button", { type: "button", title: keys === "" ? label : `${label} (${keys})`, onclick: act }, label);
    this.#store = new Store({
      changed: (state, anew) => this.#changed(state, anew),
      committed: () => {
        this.#failure = undefined;
        if (this.#store.state && (!this.#recording || this.#recording.cloud)) this.#connection.survey(this.#store.state);
        this.#writeAddress();
        this.#buttons();
      },
    });
    this.#undo = button("Undo", "Ctrl+Z", () => this.#store.undo());
    this.#redo = button("Redo", "Ctrl+Shift+Z", () => this.#store.redo());
    this.#theme = new Theme(() => this.#redress());
    this.#stage = new Stage(byId("canvas") as HTMLCanvasElement, {
      // What the frames of an exported page are loaded with does not change.
      places: () => (this.#recording || this.#timeline.isActive || this.#designing.isChoosing ? [] : (this.#first?.positions ?? [])),
      onlyTip: () => this.#store.state?.dragging === "reach",
      grab: (station) => this.#dragging.grab(station),
      move: (to) => this.#dragging.move(to),
      release: () => this.#dragging.release(),
      hover: (station) => this.#hover(station),
      looked: () => {
        this.#looks = true;
        this.#writeAddress();
      },
      drawn: (scale) => measure(scale),
      left: () => this.#toolbar.leave(),
    });
    this.#dragging = new Dragging(this.#store, this.#stage, {
      first: () => this.#first,
      isCaughtUp: () => this.#connection.isCaughtUp,
      tell: (words) => this.#controls?.tell(words),
    });
    this.#designing = new Designing(this.#store, this.#stage, {
      first: () => this.#first,
      design: (request) => this.#connection.design(request),
      name: () => this.#name,
    });
    this.#panel = new Panel((s) => this.#mark(s));
    this.#toolbar = new Toolbar({
      look: (side) => {
        this.#whole(side);
        this.#looks = side !== "isometric";
        this.#writeAddress();
      },
      parallel: (yes) => {
        this.#stage.cameras.isParallel = yes;
        this.#stage.draw();
        this.#looks = true;
        this.#writeAddress();
      },
      cut: (cut) => (this.#stage.cut = cut),
      ghost: (yes) => this.#ghost(yes),
      through: (number) => {
        const { scene } = this.#store;
        if (scene) this.#stage.through(number === undefined ? undefined : scene.cameras[number], scene);
      },
      photograph: (number, file) => void this.#photograph(number, file),
    });
    this.#film = new Film(this.#stage, () => this.#name);
    this.#timeline = new Timeline({
      load: (course) => {
        this.#acting = null;
        if (this.#store.state) this.#connection.play(course, this.#store.state);
      },
      show: (moment, at) => this.#play(moment, at),
      leave: () => {
        this.#connection.endPlay();
        this.#answers = this.#live;
        this.#markers = undefined;
        this.#acting = null;
        this.#played.length = 0;
        this.#dress();
      },
      film: (yes) => this.#film.record(yes),
    }, this.#film.isPossible);
    byId("space").append(this.#toolbar.element);
    byId("view").append(this.#timeline.element);
    const saved = {
      name: () => this.#name,
      robots: () => this.#robots.answered,
      onPaper: <T>(take: (said: Said) => Promise<T>) => this.#onPaper(take),
      failed: (message: string | undefined) => {
        this.#failure = message;
        this.#tell();
      },
    };
    byId("actions").append(
      this.#undo, this.#redo, button("Reset", "", () => this.#store.reset()), this.#theme.button, saving(this.#stage, saved, this.#film), this.#help.button,
    );
    document.body.append(this.#help.dialog);
    window.addEventListener("keydown", (event) => this.#key(event));
    // One who goes comes back to what was.
    window.addEventListener("pagehide", () => {
      if (this.#store.scene) this.#writeAddressNow();
    });
    window.addEventListener("hashchange", () => {
      window.clearTimeout(this.#writing);
      this.#lookFrom(location.hash);
      this.#store.follow(location.hash);
    });
    const recording = this.#recording;
    this.#connection = new Connection((listener) => {
      if (recording) return new Recorded(recording, listener);
      const url = new URL("/socket", location.href);
      url.protocol = url.protocol.replace("http", "ws");
      return new Live(url.href, listener);
    }, {
      scene: (scene) => this.#open(scene),
      beside: (number, scene, answer) => {
        this.#beside.add(number, scene, answer);
        this.#dress();
        if (!this.#looks) this.#whole("isometric");
      },
      shown: (all) => this.#follow(all),
      frame: (frame) => this.#receive(frame),
      whenFree: (act) => this.#stage.pace.whenFree(act),
      cloud: (cloud, words) => this.#cloud(cloud, words),
      course: (course, moments, complete, message) => {
        this.#timeline.receive(course, moments, complete);
        this.#failure = message ?? undefined;
        this.#tell();
      },
      designed: (found) => this.#designing.designed(found),
      noDesign: (id, message) => this.#designing.failed(id, message),
      told: () => this.#tell(),
      waiting: (yes) => (byId("waiting").hidden = !yes),
    });
  }

  get #name(): string {
    return this.#store.scene?.file.replace(/\.toml$/, "") ?? "robot";
  }

  /** The robot that has the handles: the first that has a shape. */
  get #first(): Solved | undefined {
    return this.#answers.find((answer) => answer.status === "solved") ?? this.#robots.shapes[0];
  }

  #open(scene: Scene): void {
    const focused = document.activeElement;
    const before = this.#store.scene;
    this.#timeline.leave();
    const stays = this.#store.open(scene, location.hash);
    // A page that was exported with a cloud shows it from the start.
    if (this.#recording?.cloud) this.#store.begin((state) => void (state.workspace = true));
    this.#dragging.end();
    this.#stage.cloud(undefined);
    this.#stage.ghost(undefined);
    this.#toolbar.hasGhost = false;
    this.#whenShown = undefined;
    this.#stage.robots([]);
    this.#robots.clear();
    [this.#answers, this.#live, this.#solvable] = [[], [], undefined];
    byId("title").textContent = scene.title;
    byId("file").textContent = `${scene.file} · whipcord ${scene.version}`;
    document.title = `${scene.title} – Whipcord`;
    this.#controls = new Controls(scene, byId("controls"), {
      change: (edit) => this.#store.change(edit),
      commit: () => this.#store.commit(),
      whenShown: (cable, act) => {
        this.#whenShown = () => act(this.#first?.cables[cable]);
        this.#catchUp();
      },
      moveTip: (to) => {
        this.#dragging.move(to);
        this.#dragging.release();
      },
    }, modelColour, this.#recording?.axes, !this.#recording || this.#recording.cloud !== undefined);
    if (!this.#recording) this.#designing.open(scene, byId("controls"));
    this.#timeline.open(this.#recording ? [] : scene.courses);
    if (this.#recording) {
      byId("note").textContent = describe(this.#recording);
      byId("note").hidden = false;
    }
    this.#ink = this.#theme.colours.ink;
    const looksAnew = this.#stage.surround(scene, this.#theme.colours);
    if (!before) this.#lookFrom(location.hash);
    else if (looksAnew) [this.#looks, this.#fits] = [false, true];
    if (stays) this.#writeAddress();
    refocus(focused);
    const spacing = significant(toUnit(gridSpacing(scene), MILLIMETRE), 3);
    byId("keys").replaceChildren(element("span", {}, `grid ${spacing} mm`), element("span", { id: "measured" }));
    this.#toolbar.cameras(scene.cameras.map(({ name }) => name));
    this.#markers = undefined;
    if (this.#store.state && (!this.#recording || this.#recording.cloud)) this.#connection.survey(this.#store.state);
    if (this.#store.state) this.#ask(this.#store.state, false);
  }

  #changed(state: State, anew: boolean): void {
    if (anew) this.#dragging.end();
    this.#timeline.leave();
    if (!this.#dragging.target) this.#controls?.limits(null);
    this.#ask(state, anew);
  }

  #ask(state: State, anew: boolean): void {
    this.#controls?.show(state, anew);
    this.#designing.show();
    this.#buttons();
    this.#connection.ask(() => this.#store.state, () => this.#dragging.target ?? null);
  }

  #receive(frame: Frame): void {
    const { state } = this.#store;
    if (!state) return;
    this.#live = frame.answers;
    if (!this.#recording && this.#store.scene) this.#designing.receive(this.#store.scene, frame);
    if (frame.reach && this.#dragging.target) {
      this.#controls?.limits(frame.reach);
      if (frame.reach.status === "found") {
        state.commands = frame.reach.commands;
        this.#controls?.show(state, false);
      }
    }
    byId("view").dataset["frame"] = String(frame.id);
    if (frame.answers[0]?.status === "solved" && this.#connection.isCaughtUp) this.#solvable = structuredClone(state);
    this.#controls?.solvable(frame.answers[0]?.status === "failed" ? this.#solvable : undefined, state);
    if (!this.#timeline.isActive) this.#answers = frame.answers;
    this.#dragging.answered(frame);
    if (!this.#timeline.isActive) {
      this.#dress();
      this.#stage.drawAtOnce();
    }
    this.#catchUp();
  }

  #play({ answers, acting, others, measured }: Played, at: number): void {
    this.#answers = answers;
    this.#acting = acting;
    this.#markers = measured
      ? measured.map((position): Marker => ({ seen: { kind: "position", position }, arc_length: null, offset: [0, 0, 0] }))
      : this.#store.scene?.measured[at];
    if (others) this.#beside.show(others);
    this.#dress();
    this.#keepInSight();
  }

  /** Another program shows something. */
  #follow(all: readonly Shown[]): void {
    let [before, rest] = [this.#streamed, this.#streamedOthers];
    const moments = all.map(({ time, shapes: [first, ...others], measured }): Played => {
      // A robot without a shape stays as it was.
      if (first) before = [first];
      rest = others.map((answer, k) => answer ?? rest[k] ?? null);
      return { time, answers: before.length > 0 ? [...before] : [...this.#live], acting: null, others: rest, measured };
    });
    [this.#streamed, this.#streamedOthers] = [before, rest];
    this.#timeline.append(moments);
  }

  async #photograph(number: number, file: File): Promise<void> {
    const { scene } = this.#store;
    const camera = scene?.cameras[number];
    if (!camera) return;
    try {
      const picture = await createImageBitmap(file, { imageOrientation: "flipY" });
      const [width, height] = camera.size;
      const apart = Math.abs(picture.width / picture.height - width / height) > 0.01;
      this.#failure = apart
        ? `the photograph has ${picture.width}×${picture.height} pixels, and the camera ${width}×${height}: take one of the same proportions`
        : undefined;
      this.#stage.photograph(camera.name, apart ? undefined : picture);
    } catch {
      this.#failure = `${file.name} is no picture that this browser reads`;
    }
    this.#tell();
  }

  /** Does what waits for the answer to the latest request, if that is what is shown. */
  #catchUp(): void {
    if (!this.#connection.isCaughtUp) return;
    const act = this.#whenShown;
    this.#whenShown = undefined;
    act?.();
  }

  /** Looks from farther away where what is played leaves the view, as long as the user has not chosen from where to look. */
  #keepInSight(): void {
    const { scene } = this.#store;
    const tips = [...this.#robots.shapes, ...this.#beside.shapes].flatMap(({ positions }) => positions.slice(-1));
    if (!scene || this.#looks || tips.every((tip) => this.#stage.sees(tip))) return;
    this.#played.push(...this.#robots.shapes.flatMap(({ positions }) => positions), ...tips);
    this.#whole("isometric");
  }

  /** Shows the shapes of the answers, and their numbers. */
  #dress(): void {
    const { scene, state } = this.#store;
    if (!scene || !state) return;
    const solved = this.#answers.filter((answer) => answer.status === "solved");
    this.#legend = this.#robots.dress(scene, state, this.#answers);
    show(byId("legend"), this.#legend);
    this.#beside.dress(state);
    this.#stage.robots([...this.#robots.groups, ...this.#beside.groups]);
    if (!this.#recording) this.#designing.dress();
    this.#stage.objects(solved[0]?.objects ?? []);
    this.#stage.marks(ellipsoids(scene, solved));
    const first = this.#first;
    const loads = !this.#timeline.isActive ? loadsOf(scene, this.#dragging.rest(state)) : this.#acting ? { ...this.#acting, pull: null } : undefined;
    const acts = acting(scene, loads, first, solved, this.#ink);
    this.#ends = acts.ends;
    const off = errors(scene, this.#markers ?? scene.measured.at(-1) ?? [], first);
    this.#stage.measured(off.balls);
    acts.arrows.push(...off.arrows);
    this.#stage.acting(acts, [...this.#dragging.labels, ...slackLabels(scene, solved[0]), ...off.labels]);
    const words = describeErrors(off);
    const told = document.getElementById("measured");
    if (told && told.textContent !== words) told.replaceChildren(...(words === "" ? [] : [key({ colour: MEASURED, label: words })]));
    const tip = this.#recording || this.#timeline.isActive ? undefined : first?.positions.at(-1);
    this.#stage.handles.tip(tip);
    const movable = state.dragging === "reach" ? tip : undefined;
    this.#stage.movable = movable;
    this.#controls?.place(movable);
    this.#controls?.slack(solved[0]?.cables);
    const pinned = this.#robots.pinned;
    this.#panel.show(scene, this.#answers, pinned && { name: "ghost", solved: pinned });
    if (this.#fits && solved.length > 0) {
      this.#fits = false;
      this.#whole("isometric");
    }
    this.#tell();
    this.#stage.draw();
  }

  #redress(): void {
    // Before there is a robot there is nothing to be shown in other colours.
    if (!this.#store.scene) return;
    this.#panel.redress();
    this.#surround(this.#theme.colours);
  }

  /** Shows all in other colours. */
  #surround(colours: Colours): void {
    const { scene } = this.#store;
    if (!scene) return;
    this.#ink = colours.ink;
    this.#stage.surround(scene, colours);
    this.#dress();
  }

  async #onPaper<T>(take: (said: Said) => Promise<T>): Promise<T> {
    this.#surround(PAPER);
    try {
      return await take({ legend: this.#legend, ink: PAPER.ink });
    } finally {
      this.#surround(this.#theme.colours);
    }
  }

  #cloud(cloud: Cloud | undefined, words: string): void {
    this.#stage.cloud(cloud && points(cloud));
    const hint = document.getElementById("cloud");
    if (!hint) return;
    hint.textContent = cloud ? describeCloud(cloud) : words;
    hint.hidden = hint.textContent === "";
  }

  #ghost(yes: boolean): void {
    const { scene } = this.#store;
    const first = yes ? this.#first : undefined;
    this.#stage.ghost(this.#robots.pin(scene, first));
    this.#toolbar.hasGhost = first !== undefined;
    this.#dress();
  }

  #hover(station: number | undefined): void {
    const place = station === undefined ? undefined : this.#first?.positions[station];
    this.#stage.handles.hover(place);
    this.#stage.draw();
  }

  #mark(s: number | undefined): void {
    const { scene } = this.#store;
    const first = this.#first;
    this.#stage.handles.mark(s === undefined || !scene || !first ? undefined : poseAt(scene, first, s).position);
    this.#stage.draw();
  }

  /** Soon: browsers take longer to write an address than the server to solve. */
  #writeAddress(): void {
    window.clearTimeout(this.#writing);
    this.#writing = window.setTimeout(() => this.#writeAddressNow(), SETTLED);
  }

  #writeAddressNow(): void {
    window.clearTimeout(this.#writing);
    const parts = [this.#store.hash, this.#looks ? viewToHash(this.#stage.view) : ""];
    const hash = parts.filter((part) => part !== "").join("&");
    history.replaceState(null, "", hash === "" ? location.pathname + location.search : `#${hash}`);
  }

  #lookFrom(hash: string): void {
    const view = viewFromHash(hash);
    this.#looks = view !== undefined;
    this.#fits = !view;
    if (view) this.#stage.view = view;
    else if (this.#store.scene) this.#stage.lookAtBase(this.#store.scene);
    this.#toolbar.isParallel = this.#stage.cameras.isParallel;
    if (this.#fits && this.#answers.length > 0) this.#dress();
  }

  #whole(side: Parameters<Stage["look"]>[1]): void {
    const { scene } = this.#store;
    if (!scene) return;
    const shapes: Vector[] = this.#robots.shapes.flatMap(({ positions }) => positions);
    const ghost = this.#robots.pinned?.positions ?? [];
    const beside = this.#beside.shapes.flatMap(({ positions }) => positions);
    this.#stage.look([scene.base.position, ...shapes, ...ghost, ...beside, ...this.#played, ...this.#ends], side);
  }

  #key(event: KeyboardEvent): void {
    const control = event.ctrlKey || event.metaKey;
    const key = event.key.toLowerCase();
    const types = event.target instanceof HTMLInputElement && event.target.type === "number";
    if (control && key === "z") {
      event.preventDefault();
      if (event.shiftKey) this.#store.redo();
      else this.#store.undo();
    } else if (control && key === "y") {
      event.preventDefault();
      this.#store.redo();
    } else if (event.key === "?" && !types) {
      this.#help.open();
    } else if (event.target === this.#stage.canvas && !control) {
      if (key === "home") {
        this.#whole("isometric");
        this.#looks = false;
        this.#writeAddress();
      } else if (key === "+" || key === "=") this.#stage.zoom(ZOOM);
      else if (key === "-") this.#stage.zoom(1 / ZOOM);
      else this.#toolbar.key(key);
    }
  }

  #buttons(): void {
    this.#undo.disabled = !this.#store.canUndo;
    this.#redo.disabled = !this.#store.canRedo;
  }

  #tell(): void {
    const failed = this.#answers.filter((answer) => answer.status === "failed");
    const lines = [
      ...this.#connection.complaints,
      ...(this.#failure === undefined ? [] : [this.#failure]),
      ...(this.#store.state?.models.length === 0 ? ["No model is chosen: tick one under Models."] : []),
      ...failed.map(({ model, message }) => `${model}: ${message}${this.#robots.has(model) ? " (in grey: the last shape that it found)" : ""}`),
    ];
    const status = byId("status");
    const text = lines.join("\n");
    if (status.textContent !== text) status.textContent = text;
    status.hidden = text === "";
  }
}

/** The bar for the present distance. */
function measure(scale: number): void {
  const { pixels, words } = scaleBar(scale, BAR);
  const bar = byId("bar");
  bar.style.width = `${pixels.toFixed(1)}px`;
  if (bar.textContent !== words) bar.textContent = words;
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
