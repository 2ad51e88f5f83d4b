// Starts the page.

import "./style.css";

import { App } from "./app";

new App();
