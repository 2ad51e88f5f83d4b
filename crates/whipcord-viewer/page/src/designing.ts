// Holes and a sketched shape: their controls, what the view shows of them, and the search for holes that take the shape.

import { Holes } from "./holes";
import { DesignMarks, type Marks } from "./marks";
import type { Designed, DesignRequest, Frame, Scene, Solved, Vector } from "./protocol";
import { Sketcher } from "./sketch";
import type { Stage } from "./stage";
import { toRequest } from "./state";
import type { Store } from "./store";

export interface DesignHost {
  /** The shape that has the handles. */
  first(): Solved | undefined;
  design(request: DesignRequest): void;
  name(): string;
}

export class Designing {
  readonly #store: Store;
  readonly #stage: Stage;
  readonly #host: DesignHost;
  readonly #marks = new DesignMarks();
  readonly #holes: Holes;
  readonly #sketch: Sketcher;
  /** Number of the latest search, and the cable whose holes it looks for. */
  #asked = 0;
  #cable = 0;
  /** What the view shows, so that it is made anew only where it is another. */
  #shown = "";

  constructor(store: Store, stage: Stage, host: DesignHost) {
    [this.#store, this.#stage, this.#host] = [store, stage, host];
    const changes = {
      change: (edit: Parameters<Store["change"]>[0]) => store.change(edit),
      commit: () => store.commit(),
    };
    this.#holes = new Holes({ ...changes, state: () => store.state, redraw: () => this.dress() });
    this.#sketch = new Sketcher({ ...changes, name: () => host.name(), design: (places, tension) => this.#design(places, tension) });
    stage.space.add(this.#marks.group);
    this.#holes.listen(stage.canvas, () => stage.cameras.camera, () => host.first());
  }

  /** Whether clicks on the robot choose holes, so that nothing else is to take them. */
  get isChoosing(): boolean {
    return this.#holes.isChoosing;
  }

  /** Shows the controls of a file below the others. */
  open(scene: Scene, into: HTMLElement): void {
    this.#asked++;
    this.#holes.open(scene);
    this.#sketch.open(scene, this.#holes.isPossible);
    into.append(this.#holes.element, this.#sketch.element);
    this.show();
  }

  show(): void {
    const { state } = this.#store;
    if (!state) return;
    this.#holes.show(state);
    this.#sketch.show(state);
    this.dress();
  }

  receive(scene: Scene, frame: Frame): void {
    this.#holes.receive(scene, frame);
  }

  /** What the view shows. */
  dress(): void {
    const { scene, state } = this.#store;
    if (!scene || !state) return;
    const marks: Marks = { wanted: this.#sketch.places(), ...this.#holes.places(state, this.#host.first()) };
    const shown = JSON.stringify(marks);
    if (shown === this.#shown) return;
    this.#shown = shown;
    this.#marks.show(marks, scene.length, scene.disks[0]?.hole_radius ?? 0);
    this.#stage.draw();
  }

  designed(found: Designed): void {
    if (found.id !== this.#asked) return;
    this.#store.change((state) => {
      this.#holes.put(state, this.#cable, found.holes);
      state.commands = found.commands;
    });
    this.#store.commit();
    this.#sketch.designed(found);
  }

  failed(id: number, message: string): void {
    if (id === this.#asked) this.#sketch.tell(message);
  }

  #design(places: Vector[], tension: boolean): void {
    const { state } = this.#store;
    if (!state || places.length === 0) return;
    this.#cable = this.#holes.cable;
    this.#host.design({ request: toRequest(state, ++this.#asked), cable: this.#cable, tension, places });
  }
}
