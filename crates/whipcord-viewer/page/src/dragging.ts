// What dragging does: a spring pulls at a place of the backbone, or commands are sought that bring the tip to the pointer.

import { TOUCHING } from "./colours";
import { conjugate, norm, rotate, tipFrame } from "./geometry";
import type { Label } from "./labels";
import type { Frame, Scene, Solved, Vector } from "./protocol";
import { Spring } from "./spring";
import type { Stage } from "./stage";
import type { State } from "./state";
import type { Store } from "./store";
import { quantityOf, significant } from "./units";

/** Of words beside what is held: dark enough on light and dark. */
const HELD = "#b87400";

export interface Dragged {
  /** The robot that is dragged: the first that has a shape. */
  first(): Solved | undefined;
  /** Whether what is shown answers the latest request. */
  isCaughtUp(): boolean;
  /** What keeps it from following, in words. */
  tell(words: string): void;
}

export class Dragging {
  readonly #store: Store;
  readonly #stage: Stage;
  readonly #of: Dragged;
  #spring: Spring | undefined;
  /** Where the tip is dragged to. */
  #target: Vector | undefined;
  /** What keeps the tip from that place. */
  #limit = "";
  /** Whether it has been let go, but the answer to the last place is still waited for. */
  #letGo = false;

  constructor(store: Store, stage: Stage, of: Dragged) {
    [this.#store, this.#stage, this.#of] = [store, stage, of];
  }

  get target(): Vector | undefined {
    return this.#target;
  }

  /** What is written at the pointer. */
  get labels(): Label[] {
    const spring = this.#spring;
    if (spring) {
      const size = quantityOf("force", norm(spring.force));
      const words = spring.isStopped ? `no equilibrium beyond ${size}` : spring.isRestless ? `gives way at ${size}` : size;
      return [{ text: words, at: this.#beside(spring.to), from: spring.to, weight: 9, colour: spring.isStopped || spring.isRestless ? TOUCHING : HELD }];
    }
    return this.#target && this.#limit !== "" ? [{ text: this.#limit, at: this.#beside(this.#target), from: this.#target, weight: 9, colour: TOUCHING }] : [];
  }

  /** The state without the force of the spring, which is drawn already. */
  rest(state: State): State {
    const spring = this.#spring;
    if (!spring) return state;
    const isTip = spring.station === (this.#store.scene?.stations.length ?? 0) - 1;
    return isTip ? { ...state, tipForce: [0, 0, 0] } : { ...state, pull: null };
  }

  #beside([x, y, z]: Vector): Vector {
    return [x, y, z + 0.06 * (this.#store.scene?.length ?? 0)];
  }

  /** A place of the backbone is taken hold of. */
  grab(station: number): void {
    const { scene, state } = this.#store;
    const first = this.#of.first();
    this.#stage.handles.hover(undefined);
    if (!scene || !state || !first || state.dragging === "reach") return;
    const at = first.positions[station]!;
    const isTip = station === first.positions.length - 1;
    const held = isTip ? rotate(this.#frame(scene, first), state.tipForce) : this.#pulledAt(scene, state, station);
    this.#spring = new Spring(station, at, held, scene.ranges.force, scene.length);
    this.#draw(first);
  }

  move(to: Vector): void {
    if (this.#spring) {
      this.#spring.move(to);
      if (this.#of.isCaughtUp()) this.#pull();
      const first = this.#of.first();
      if (first) this.#draw(first);
      return;
    }
    if (this.#store.state?.dragging !== "reach") return;
    [this.#target, this.#letGo] = [to, false];
    this.#stage.handles.target(to);
    this.#stage.draw();
    this.#store.change(() => {});
  }

  release(): void {
    if (this.#spring) {
      this.#spring = undefined;
      this.#stage.handles.spring(undefined);
      this.#stage.draw();
      this.#store.change((state) => this.#readable(state));
      this.#store.commit();
    } else if (this.#target) {
      this.#letGo = true;
      this.settle();
    }
  }

  /** The shape for the latest force, or place, has come. */
  answered(frame: Frame): void {
    const { reach } = frame;
    this.#limit =
      !reach || (reach.status === "found" && reach.reached) ? ""
      : reach.status === "failed" ? "it cannot be moved"
      : `${significant(1e3 * reach.distance, 3)} mm away: ${reach.limits[0]?.words ?? "no command comes nearer"}`;
    const first = this.#of.first();
    if (this.#spring && first) {
      if (frame.answers.find(({ model }) => model === first.model)?.status === "failed") {
        this.#set(this.#spring.back());
        this.#of.tell(`There is no equilibrium under more than ${quantityOf("force", norm(this.#spring.force))} here: the last one is shown.`);
      } else if (this.#of.isCaughtUp()) this.#pull();
      this.#draw(first);
    }
    this.settle();
  }

  /** Ends dragging once the answer to the last place is there. */
  settle(): void {
    if (!this.#letGo || !this.#of.isCaughtUp()) return;
    this.end();
    this.#store.commit();
  }

  /** Forgets what is dragged. */
  end(): void {
    [this.#target, this.#letGo, this.#spring] = [undefined, false, undefined];
    this.#stage.handles.target(undefined);
    this.#stage.handles.spring(undefined);
    this.#stage.draw();
  }

  /** The next force of the spring. */
  #pull(): void {
    const first = this.#of.first();
    const spring = this.#spring;
    if (!spring || !first) return;
    const force = spring.next(first.positions[spring.station]!);
    this.#stage.canvas.dataset["rests"] = String(force === undefined);
    if (spring.isRestless) this.#of.tell("The robot gives way to this force: it jumps from shape to shape, and the spring no longer pulls harder.");
    if (!force) return;
    this.#of.tell("");
    this.#set(force);
  }

  #set(force: Vector): void {
    const { scene } = this.#store;
    const [first, spring] = [this.#of.first(), this.#spring];
    if (!scene || !first || !spring) return;
    const isTip = spring.station === first.positions.length - 1;
    this.#store.change((state) => {
      if (isTip) state.tipForce = rotate(conjugate(this.#frame(scene, first)), force);
      else state.pull = { arc_length: scene.stations[spring.station]!, force };
    });
  }

  #draw(first: Solved): void {
    const spring = this.#spring;
    if (!spring) return;
    this.#stage.handles.spring([first.positions[spring.station]!, spring.to]);
    this.#stage.draw();
  }

  #frame(scene: Scene, first: Solved): ReturnType<typeof tipFrame> {
    return tipFrame(scene, first.orientations.at(-1)!);
  }

  /** The force that pulls at a place already: there is one place at a time. */
  #pulledAt(scene: Scene, state: State, station: number): Vector {
    const { pull } = state;
    return pull && Math.abs(pull.arc_length - scene.stations[station]!) < 1e-9 * scene.length ? pull.force : [0, 0, 0];
  }

  /** Forces in steps that can be read. */
  #readable(state: State): void {
    const { scene } = this.#store;
    if (!scene) return;
    const step = 10 ** Math.floor(Math.log10(scene.ranges.force) - 2.5);
    const round = (force: Vector): Vector => force.map((f) => Number((Math.round(f / step) * step).toPrecision(6))) as Vector;
    state.tipForce = round(state.tipForce);
    if (state.pull) state.pull.force = round(state.pull.force);
  }
}
