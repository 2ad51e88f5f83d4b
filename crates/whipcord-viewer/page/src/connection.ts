// Requests and their answers: numbers, what is outdated, and what is waited for. It knows neither the page nor what it shows.

import type { Answer, Cloud, Course, Designed, DesignRequest, Frame, Moment, Request, Scene, Shown, Track } from "./protocol";
import type { Listener, Source } from "./source";
import { toRequest, type State } from "./state";

export interface Hearer {
  scene(scene: Scene): void;
  /** Another robot beside that of the file. */
  beside(number: number, scene: Scene, answer: Answer): void;
  /** All that another program has shown since the last picture of the display. */
  shown(all: readonly Shown[]): void;
  /** The answer to the latest request that has one, once for each picture of the display. */
  frame(frame: Frame): void;
  /** Does this when the last picture is drawn. */
  whenFree(act: () => void): void;
  /** What is known of where the tip can go: a cloud, or in words what keeps it. */
  cloud(cloud: Cloud | undefined, words: string): void;
  /** The shapes of a course so far. */
  course(course: Course, moments: readonly Moment[], complete: boolean, message: string | null): void;
  /** Holes that were looked for; or there are none, and why. */
  designed(found: Designed): void;
  noDesign(id: number, message: string): void;
  /** Lines that tell what is wrong. */
  told(): void;
  waiting(yes: boolean): void;
}

/** How long an answer may take before the page says that it is waited for, in ms. */
const PATIENCE = 400;

export class Connection {
  readonly #source: Source;
  readonly #hearer: Hearer;
  #asked = 0;
  /** Requests up to this one were of an earlier version of the file. */
  #outdated = 0;
  #drawn = 0;
  #scheduled = false;
  /** Whether a request has gone out, and whether an answer has been shown, since the last picture of the display. */
  #hasAsked = false;
  #hasShown = false;
  /** Whether a picture of the display is being made. */
  #inPicture = false;
  #patience = 0;
  #frame: Frame | undefined;
  #connected = false;
  #broken: string | undefined;
  #error: string | undefined;
  /** What the latest survey was asked for, and its number. */
  #surveyed = "";
  #survey = 0;
  #play = 0;
  #moments: Moment[] = [];
  #shown: Shown[] = [];

  /** `source` makes what answers, told who listens. */
  constructor(source: (listener: Listener) => Source, hearer: Hearer) {
    this.#hearer = hearer;
    this.#source = source({
      scene: (scene) => {
        this.#broken = undefined;
        this.#outdated = this.#asked;
        this.#frame = undefined;
        this.#surveyed = "";
        this.#play++;
        hearer.scene(scene);
      },
      beside: (number, scene, answer) => hearer.beside(number, scene, answer),
      shown: (shown) => {
        this.#shown.push(shown);
        if (this.#shown.length > 1) return;
        requestAnimationFrame(() => hearer.whenFree(() => hearer.shown(this.#shown.splice(0))));
      },
      frame: (frame) => this.#receive(frame),
      cloud: (cloud) => {
        if (cloud.id === this.#survey && this.#surveyed !== "") hearer.cloud(cloud, "");
      },
      noCloud: (id, message) => {
        if (id === this.#survey) hearer.cloud(undefined, message);
      },
      track: (track) => this.#follow(track),
      designed: (found) => hearer.designed(found),
      noDesign: (id, message) => hearer.noDesign(id, message),
      broken: (message) => {
        this.#broken = message;
        hearer.told();
      },
      connected: (yes) => {
        this.#connected = yes;
        if (!yes) this.#wait(false);
        hearer.told();
      },
      error: (message) => {
        this.#error = message;
        this.#wait(false);
        hearer.told();
      },
    });
  }

  /** What is wrong with file and server. */
  get complaints(): string[] {
    const lines = [this.#connected ? undefined : "No connection to whipcord: is it still running?", this.#broken, this.#error];
    return lines.filter((line) => line !== undefined);
  }

  /** Asks for the shape of a state: at once, and then once for each picture of the display, for what the state then is. */
  ask(state: () => State | undefined, target: () => Request["target"]): void {
    if (this.#scheduled) return;
    this.#scheduled = true;
    const send = (): void => {
      this.#scheduled = false;
      const now = state();
      if (!now) return;
      this.#hasAsked = true;
      requestAnimationFrame(() => (this.#hasAsked = false));
      this.#source.ask(toRequest(now, ++this.#asked, target()));
      // Most answers come at once; who waits is told that it goes on.
      if (this.#connected) this.#patience ||= window.setTimeout(() => this.#wait(true), PATIENCE);
    };
    // What changes the state may change more of it.
    if (this.#hasAsked) requestAnimationFrame(send);
    else queueMicrotask(send);
  }

  /** Whether what is shown is the answer to the latest request. */
  get isCaughtUp(): boolean {
    return this.#drawn === this.#asked && !this.#scheduled;
  }

  /** Asks where the tip can go, if that is to be shown and is not known for these loads. */
  survey(state: State): void {
    const kinds = state.commands.map((command) => Object.keys(command)[0]);
    const { tipForce, tipMoment, gravity, pull, models, holes } = state;
    const wanted = state.workspace ? JSON.stringify([tipForce, tipMoment, gravity, pull, models[0], kinds, holes]) : "";
    if (wanted === this.#surveyed) return;
    const ended = this.#surveyed !== "";
    this.#surveyed = wanted;
    if (wanted !== "") {
      this.#source.survey(toRequest(state, ++this.#survey));
      this.#hearer.cloud(undefined, "Surveying…");
    } else if (ended) {
      this.#source.survey(undefined);
      this.#hearer.cloud(undefined, "");
    }
  }

  /** Asks for a course of shapes. */
  play(course: Course, state: State): void {
    this.#moments = [];
    this.#source.play({ course, request: toRequest(state, ++this.#play) });
  }

  /** Looks for holes. */
  design(request: DesignRequest): void {
    this.#source.design(request);
  }

  endPlay(): void {
    this.#play++;
    this.#source.play(undefined);
  }

  #follow({ id, course, from, moments, complete, message }: Track): void {
    if (id !== this.#play) return;
    const all = this.#moments.slice(0, from);
    for (const moment of moments) all.push({ ...moment, acting: moment.acting ?? all.at(-1)?.acting ?? null });
    this.#moments = all;
    this.#hearer.course(course, this.#moments, complete, message);
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
    const show = (): void => this.#hearer.whenFree(() => {
      const latest = this.#frame;
      this.#frame = undefined;
      if (!latest) return;
      this.#drawn = latest.id;
      // What is drawn for the picture that is being made leaves room for another before the next one.
      if (!this.#inPicture) {
        this.#hasShown = true;
        requestAnimationFrame(() => (this.#hasShown = false));
      }
      this.#hearer.frame(latest);
    });
    // What is drawn before the display begins its picture is in it, and is drawn while the page does other things.
    if (!this.#hasShown) return show();
    requestAnimationFrame(() => {
      this.#inPicture = true;
      show();
      this.#inPicture = false;
    });
  }

  #wait(yes: boolean): void {
    window.clearTimeout(this.#patience);
    this.#patience = 0;
    this.#hearer.waiting(yes);
  }
}
