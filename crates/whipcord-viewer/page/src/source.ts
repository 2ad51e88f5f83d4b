// Where answers come from: the server, over a WebSocket.

import {
  decode, encode, encodeDesign, encodePlay, encodeSurvey, type Answer, type Cloud, type Designed, type DesignRequest, type Frame, type PlayRequest, type Request, type Scene, type Shown, type Track,
} from "./protocol";

export interface Listener {
  scene(scene: Scene): void;
  /** Another robot, which is shown beside that of the file. */
  beside(number: number, scene: Scene, answer: Answer): void;
  /** What another program shows. */
  shown(shown: Shown): void;
  frame(frame: Frame): void;
  /** Where the tip can go. */
  cloud(cloud: Cloud): void;
  /** That is not known, and why. */
  noCloud(id: number, message: string): void;
  /** Holes that were looked for; or there are none, and why. */
  designed(found: Designed): void;
  noDesign(id: number, message: string): void;
  /** A part of a course that was asked for. */
  track(track: Track): void;
  /** The file on disk cannot be used as it now is. */
  broken(message: string): void;
  /** Whether answers can be had at all. */
  connected(yes: boolean): void;
  /** The server does not understand the page. */
  error(message: string): void;
}

/** What answers requests. A newer request makes older ones void. */
export interface Source {
  ask(request: Request): void;
  /** Asks where the tip can go; without a request nobody waits for that any more. */
  survey(request: Request | undefined): void;
  /** Asks for a course of shapes; without a request nobody waits for one any more. */
  play(request: PlayRequest | undefined): void;
  /** Looks for holes. */
  design(request: DesignRequest): void;
}

/** How long to wait before connecting again, in ms. */
const PATIENCE = 1000;

export class Live implements Source {
  #socket: WebSocket | undefined;
  #waiting: Request | undefined;
  #waitingSurvey: Request | undefined;
  readonly #url: string;
  readonly #listener: Listener;

  constructor(url: string, listener: Listener) {
    this.#url = url;
    this.#listener = listener;
    this.#connect();
  }

  ask(request: Request): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(encode(request));
    else this.#waiting = request;
  }

  survey(request: Request | undefined): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(encodeSurvey(request));
    else this.#waitingSurvey = request;
  }

  play(request: PlayRequest | undefined): void {
    // Without a connection there is nothing to play: who presses again asks anew.
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(encodePlay(request));
  }

  design(request: DesignRequest): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(encodeDesign(request));
    else this.#listener.noDesign(request.request.id, "No connection to whipcord: try again when there is one.");
  }

  #connect(): void {
    const socket = new WebSocket(this.#url);
    this.#socket = socket;
    socket.addEventListener("open", () => {
      this.#listener.connected(true);
      if (this.#waiting) this.ask(this.#waiting);
      this.#waiting = undefined;
      if (this.#waitingSurvey) this.survey(this.#waitingSurvey);
      this.#waitingSurvey = undefined;
    });
    socket.addEventListener("message", (event) => this.#hear(String(event.data)));
    socket.addEventListener("close", () => {
      this.#listener.connected(false);
      setTimeout(() => this.#connect(), PATIENCE);
    });
  }

  #hear(text: string): void {
    const message = decode(text);
    switch (message.type) {
      case "scene":
        return this.#listener.scene(message);
      case "beside":
        return this.#listener.beside(message.number, message.scene, message.answer);
      case "shown":
        return this.#listener.shown(message);
      case "frame":
        return this.#listener.frame(message);
      case "cloud":
        return this.#listener.cloud(message);
      case "track":
        return this.#listener.track(message);
      case "no_cloud":
        return this.#listener.noCloud(message.id, message.message);
      case "designed":
        return this.#listener.designed(message);
      case "no_design":
        return this.#listener.noDesign(message.id, message.message);
      case "broken":
        return this.#listener.broken(message.message);
      case "error":
        return this.#listener.error(message.message);
    }
  }
}
