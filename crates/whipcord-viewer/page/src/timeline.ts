// Plays the steps of a file, its motion, or what another program shows: play, scrub, speed and loop.

import { element } from "./dom";
import type { Answer, Course, CourseChoice, Moment, Vector } from "./protocol";
import { fixed, significant } from "./units";

/** A shape of what is played; of a stream also those of the other robots, and what was measured. */
export interface Played extends Moment {
  others?: readonly (Answer | null)[];
  measured?: readonly Vector[];
}

/** What another program shows has no end that is known. */
type Choice = CourseChoice | { course: "stream" };

export interface Playing {
  /** Asks for the shapes of a course. */
  load(course: Course): void;
  /** Shows a shape of it, by its number. */
  show(moment: Played, at: number): void;
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
/** Shapes of a stream that are kept, and how many are dropped at once when there are more. */
const MOST = 6000;
const DROPPED = 600;

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
  #choices: readonly Choice[] = [];
  #moments: readonly Played[] = [];
  readonly #stream: Played[] = [];
  /** Whether the latest shape of a stream is shown as it comes. */
  #follows = false;
  #isComplete = false;
  #loaded: Choice["course"] | undefined;
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
      const to = Number(this.#scrub.value);
      this.#pause();
      this.#loadOnce();
      this.#go(to);
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
      this.#start(0);
    });
    this.element.append(
      this.#course, this.#play, this.#scrub, this.#time, this.#speed,
      element("span", { class: "choice" }, this.#loop, element("label", { for: "loop" }, "Loop")), this.#film, this.#live,
    );
  }

  /** The courses of a file. */
  open(choices: readonly CourseChoice[]): void {
    this.#stream.length = 0;
    this.#offer(choices);
    this.#pick();
  }

  #offer(choices: readonly Choice[]): void {
    this.#choices = choices;
    this.element.hidden = choices.length === 0;
    const words = (choice: Choice): string =>
      choice.course === "stream" ? "Stream"
      : choice.course === "steps" ? `Steps (${choice.count})`
      : `Motion (${significant(choice.duration ?? 0, 3)} s)`;
    this.#course.replaceChildren(...choices.map((choice) => element("option", { value: choice.course }, words(choice))));
  }

  /** What another program shows now: followed from the first on, until the user looks at something else. */
  append(moments: readonly Played[]): void {
    if (!this.#choices.some(({ course }) => course === "stream")) {
      this.#offer([{ course: "stream" }, ...this.#choices]);
      this.#course.value = "stream";
      this.#pick();
      this.#start();
    }
    this.#stream.push(...moments);
    const isShown = this.#loaded === "stream";
    if (this.#stream.length > MOST) {
      const dropped = this.#stream.splice(0, this.#stream.length - MOST + DROPPED).length;
      if (isShown) this.#at = Math.max(this.#at - dropped, 0);
    }
    if (!isShown) return;
    this.#scrub.max = String(this.#stream.length - 1);
    if (this.#follows) this.#go(this.#stream.length - 1);
    else this.#say();
  }

  get isActive(): boolean {
    return this.#loaded !== undefined;
  }

  get choice(): Choice | undefined {
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
    [this.#loaded, this.#moments, this.#isComplete, this.#at, this.#follows] = [undefined, [], false, 0, false];
    this.#live.disabled = true;
    this.#scrub.value = "0";
    this.#say();
  }

  #pick(): void {
    const was = this.isActive;
    this.#forget();
    const { choice } = this;
    const count = choice?.course === "stream" ? this.#stream.length : (choice?.count ?? 1);
    this.#scrub.max = String(Math.max(count - 1, 0));
    this.#say();
    if (was) this.#playing.leave();
  }

  #loadOnce(): void {
    const course = this.choice?.course;
    if (course === undefined || this.#loaded === course) return;
    this.#loaded = course;
    this.#live.disabled = false;
    if (course !== "stream") return this.#playing.load(course);
    this.#moments = this.#stream;
    this.#at = Math.max(this.#stream.length - 1, 0);
  }

  /** Plays from where one is, or from this place. */
  #start(from?: number): void {
    this.#loadOnce();
    if (from !== undefined) this.#at = from;
    // At the end of a stream the next shapes are waited for.
    this.#follows = this.#loaded === "stream" && !this.#films && this.#at >= this.#moments.length - 1;
    if (this.#isComplete && this.#at >= this.#moments.length - 1) this.#at = 0;
    this.#runs = true;
    this.#play.textContent = "Pause";
    this.#time0();
    requestAnimationFrame(() => this.#tick());
  }

  #pause(): void {
    this.#runs = false;
    this.#follows = false;
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
    if (next !== this.#at && !this.#follows) this.#go(next);
    if (this.#at >= last && last >= 0) {
      const streams = this.#loaded === "stream";
      // The end of a stream is that of its film.
      if (streams && this.#films) return this.#pause();
      if (streams && this.#loop.checked && !this.#follows) {
        this.#go(0);
        this.#time0();
      } else if (streams && !this.#follows) {
        this.#follows = true;
        this.#say();
      } else if (streams) {
        // The next shape comes by itself.
      } else if (!this.#isComplete) {
        // What is not there yet is waited for.
        this.#time0();
      } else if (now > this.#secondsOf(this.#moments[last]) + (this.#loaded === "steps" ? STEP : 0)) {
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
    if (moment) this.#playing.show(moment, this.#at);
  }

  #say(): void {
    const { choice } = this;
    const moment = this.#moments[this.#at];
    this.element.dataset["at"] = this.isActive ? String(this.#at) : "";
    this.element.dataset["known"] = String(this.#moments.length);
    if (choice?.course === "stream") {
      const words = `${moment ? fixed(moment.time, 2) : "0"} s, ${this.#follows ? "latest" : `${this.#at + 1} of ${this.#stream.length}`}`;
      this.#time.textContent = words;
      this.#scrub.setAttribute("aria-valuetext", words);
      return;
    }
    const count = this.#isComplete ? this.#moments.length : (choice?.count ?? 0);
    const known = this.isActive && !this.#isComplete ? ` (${this.#moments.length} of ${count} solved)` : "";
    const words =
      choice?.course === "steps"
        ? `step ${this.#at + 1} of ${count}`
        : `${moment ? fixed(moment.time, 2) : "0"} s of ${significant(choice?.duration ?? 0, 3)} s`;
    this.#time.textContent = words + known;
    this.#scrub.setAttribute("aria-valuetext", words);
  }
}
