// Where answers come from: the server, over a WebSocket.

import { decode, encode, type Frame, type Request, type Scene } from "./protocol";

export interface Listener {
  scene(scene: Scene): void;
  frame(frame: Frame): void;
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
}

/** How long to wait before connecting again, in ms. */
const PATIENCE = 1000;

export class Live implements Source {
  #socket: WebSocket | undefined;
  #waiting: Request | undefined;
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

  #connect(): void {
    const socket = new WebSocket(this.#url);
    this.#socket = socket;
    socket.addEventListener("open", () => {
      this.#listener.connected(true);
      if (this.#waiting) this.ask(this.#waiting);
      this.#waiting = undefined;
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
      case "frame":
        return this.#listener.frame(message);
      case "broken":
        return this.#listener.broken(message.message);
      case "error":
        return this.#listener.error(message.message);
    }
  }
}
