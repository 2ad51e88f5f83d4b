// Plays the steps of a file, or its motion: play, scrub, speed and loop.

import { element } from "./dom";
import type { Course, CourseChoice, Moment } from "./protocol";
import { fixed, significant } from "./units";

export interface Playing {
  /** Asks for the shapes of a course. */
  load(course: Course): void;
  /** Shows a shape of it. */
  show(moment: Moment): void;
  /** Back to what the sliders say. */
  leave(): void;
  /** A film begins, and ends. */
  film(yes: boolean): void;
}

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5] as const;
/** How long a step is shown at the usual speed, in s. */
const STEP = 0.5;
/** How long the last shape is in a film, in ms. */
const TAIL = 400;

export class Timeline {
  readonly element = element("div", { id: "timeline", role: "group", "aria-label": "Timeline", hidden: true });
  readonly #playing: Playing;
  readonly #course = element("select", { "aria-label": "What is played" });
  readonly #play = element("button", { type: "button", id: "play" }, "Play");
  readonly #scrub = element("input", { type: "range", id: "scrub", min: 0, max: 0, step: 1, value: 0, "aria-label": "Place in the course" });
  readonly #time = element("output", { id: "time" });
  readonly #speed = element("select", { "aria-label": "Speed" });
  readonly #loop = element("input", { type: "checkbox", id: "loop" });
  readonly #film = element("button", { type: "button", title: "A film of the whole course, as WebM" }, "Film");
  readonly #live = element("button", { type: "button", title: "Back to what the sliders say" }, "Live");
  #choices: readonly CourseChoice[] = [];
  #moments: readonly Moment[] = [];
  #isComplete = false;
  #loaded: Course | undefined;
  #at = 0;
  #runs = false;
  #films = false;
  /** Of the display, in ms, when the shape was shown that the next ones are timed from, and the time of that shape. */
  #begun: [number, number] = [0, 0];

  constructor(playing: Playing, canFilm: boolean) {
    this.#playing = playing;
    for (const speed of SPEEDS) this.#speed.append(element("option", { value: speed, selected: speed === 1 }, `${speed}×`));
    this.#play.addEventListener("click", () => (this.#runs ? this.#pause() : this.#start()));
    this.#scrub.addEventListener("input", () => {
      this.#pause();
      this.#loadOnce();
      this.#go(Number(this.#scrub.value));
    });
    this.#speed.addEventListener("change", () => this.#time0());
    this.#course.addEventListener("change", () => this.#pick());
    this.#live.addEventListener("click", () => this.leave());
    this.#film.disabled = !canFilm;
    this.#film.addEventListener("click", () => {
      this.#loop.checked = false;
      this.#at = 0;
      this.#films = true;
      playing.film(true);
      this.#start();
    });
    this.element.append(
      this.#course, this.#play, this.#scrub, this.#time, this.#speed,
      element("span", { class: "choice" }, this.#loop, element("label", { for: "loop" }, "Loop")), this.#film, this.#live,
    );
  }

  /** The courses of a file. */
  open(choices: readonly CourseChoice[]): void {
    this.#choices = choices;
    this.element.hidden = choices.length === 0;
    const words = ({ course, count, duration }: CourseChoice): string =>
      course === "steps" ? `Steps (${count})` : `Motion (${significant(duration ?? 0, 3)} s)`;
    this.#course.replaceChildren(...choices.map((choice) => element("option", { value: choice.course }, words(choice))));
    this.#pick();
  }

  get isActive(): boolean {
    return this.#loaded !== undefined;
  }

  get choice(): CourseChoice | undefined {
    return this.#choices.find(({ course }) => course === this.#course.value);
  }

  /** The shapes of the course so far. */
  receive(course: Course, moments: readonly Moment[], complete: boolean): void {
    if (course !== this.#loaded) return;
    const first = this.#moments.length === 0;
    [this.#moments, this.#isComplete] = [moments, complete];
    if (complete) this.#scrub.max = String(Math.max(moments.length - 1, 0));
    if (first || this.#at >= moments.length) this.#go(Math.min(this.#at, moments.length - 1));
    else this.#say();
    if (complete && moments.length < 2) this.#pause();
  }

  /** Back to what the sliders say. */
  leave(): void {
    if (!this.isActive) return;
    this.#forget();
    this.#playing.leave();
  }

  #forget(): void {
    this.#pause();
    [this.#loaded, this.#moments, this.#isComplete, this.#at] = [undefined, [], false, 0];
    this.#live.disabled = true;
    this.#scrub.value = "0";
    this.#say();
  }

  #pick(): void {
    const was = this.isActive;
    this.#forget();
    this.#scrub.max = String(Math.max((this.choice?.count ?? 1) - 1, 0));
    this.#say();
    if (was) this.#playing.leave();
  }

  #loadOnce(): void {
    const course = this.choice?.course;
    if (course === undefined || this.#loaded === course) return;
    this.#loaded = course;
    this.#live.disabled = false;
    this.#playing.load(course);
  }

  #start(): void {
    this.#loadOnce();
    if (this.#isComplete && this.#at >= this.#moments.length - 1) this.#at = 0;
    this.#runs = true;
    this.#play.textContent = "Pause";
    this.#time0();
    requestAnimationFrame(() => this.#tick());
  }

  #pause(): void {
    this.#runs = false;
    this.#play.textContent = "Play";
    if (this.#films) {
      this.#films = false;
      // The last shape is seen for a while.
      window.setTimeout(() => this.#playing.film(false), TAIL);
    }
  }

  #secondsOf(moment: Moment | undefined): number {
    return (moment?.time ?? 0) * (this.#loaded === "steps" ? STEP : 1);
  }

  #time0(): void {
    this.#begun = [performance.now(), this.#secondsOf(this.#moments[this.#at])];
  }

  #tick(): void {
    if (!this.#runs) return;
    const [since, from] = this.#begun;
    const now = from + ((performance.now() - since) / 1e3) * Number(this.#speed.value);
    const last = this.#moments.length - 1;
    let next = this.#at;
    while (next < last && this.#secondsOf(this.#moments[next + 1]) <= now) next++;
    if (next !== this.#at) this.#go(next);
    if (this.#at >= last && last >= 0) {
      // What is not there yet is waited for.
      if (!this.#isComplete) this.#time0();
      else if (now > this.#secondsOf(this.#moments[last]) + (this.#loaded === "steps" ? STEP : 0)) {
        if (!this.#loop.checked) return this.#pause();
        this.#go(0);
        this.#time0();
      }
    }
    requestAnimationFrame(() => this.#tick());
  }

  #go(at: number): void {
    this.#at = Math.max(at, 0);
    this.#scrub.value = String(this.#at);
    this.#say();
    const moment = this.#moments[this.#at];
    if (moment) this.#playing.show(moment);
  }

  #say(): void {
    const { choice } = this;
    const count = this.#isComplete ? this.#moments.length : (choice?.count ?? 0);
    const moment = this.#moments[this.#at];
    const known = this.isActive && !this.#isComplete ? ` (${this.#moments.length} of ${count} solved)` : "";
    const words =
      choice?.course === "steps"
        ? `step ${this.#at + 1} of ${count}`
        : `${moment ? fixed(moment.time, 2) : "0"} s of ${significant(choice?.duration ?? 0, 3)} s`;
    this.#time.textContent = words + known;
    this.#scrub.setAttribute("aria-valuetext", words);
    this.element.dataset["at"] = this.isActive ? String(this.#at) : "";
    this.element.dataset["known"] = String(this.#moments.length);
  }
}
