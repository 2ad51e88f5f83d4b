// What the user has set, and what undo goes back to. It knows neither the page nor the server.

import type { Scene } from "./protocol";
import { fromHash, History, initialState, rebase, same, toHash, type State } from "./state";

export interface Watcher {
  /** The state is another: while a slider moves, or `anew`, over what is being typed too. */
  changed(state: State, anew: boolean): void;
  /** A change is done with. */
  committed(state: State): void;
}

export class Store {
  #scene: Scene | undefined;
  #state: State | undefined;
  #initial: State | undefined;
  #history: History | undefined;
  readonly #watcher: Watcher;

  constructor(watcher: Watcher) {
    this.#watcher = watcher;
  }

  get scene(): Scene | undefined {
    return this.#scene;
  }

  get state(): State | undefined {
    return this.#state;
  }

  get initial(): State | undefined {
    return this.#initial;
  }

  /** Takes the robot of a file, or of another version of it: what the user has moved then stays as it is, and so does what undo goes
   * back to. Whether it stays. */
  open(scene: Scene, hash: string): boolean {
    const [before, initial] = [this.#scene, this.#initial];
    const fits = initial !== undefined && JSON.stringify(before?.sliders) === JSON.stringify(scene.sliders);
    const stays = fits && this.#state !== undefined && this.#history !== undefined;
    if (fits && this.#state && this.#history) {
      const again = (state: State): State => rebase(state, initial, scene);
      this.#state = again(this.#state);
      this.#history.rebase(again);
    } else {
      this.#state = fromHash(hash, scene);
      this.#history = new History(this.#state);
    }
    this.#scene = scene;
    this.#initial = initialState(scene);
    return stays;
  }

  /** Changes state and initial state alike: what a page begins with. */
  begin(edit: (state: State) => void): void {
    if (this.#state) edit(this.#state);
    if (this.#initial) edit(this.#initial);
  }

  change(edit: (state: State) => void): void {
    if (!this.#state) return;
    edit(this.#state);
    this.#watcher.changed(this.#state, false);
  }

  commit(): void {
    if (!this.#state) return;
    this.#history?.commit(this.#state);
    this.#watcher.committed(this.#state);
  }

  undo(): void {
    this.#set(this.#history?.undo());
  }

  redo(): void {
    this.#set(this.#history?.redo());
  }

  reset(): void {
    this.#set(this.#initial && structuredClone(this.#initial));
  }

  /** Takes what an address says. */
  follow(hash: string): void {
    if (!this.#scene || !this.#state) return;
    const state = fromHash(hash, this.#scene);
    if (!same(state, this.#state)) this.#set(state);
  }

  get canUndo(): boolean {
    return this.#history?.canUndo ?? false;
  }

  get canRedo(): boolean {
    return this.#history?.canRedo ?? false;
  }

  /** What is not as in the file, as the part of an address. */
  get hash(): string {
    return this.#state && this.#initial ? toHash(this.#state, this.#initial) : "";
  }

  #set(state: State | undefined): void {
    if (!state) return;
    this.#state = state;
    this.#watcher.changed(state, true);
    this.commit();
  }
}
