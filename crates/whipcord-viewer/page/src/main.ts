// Starts the page.

import "./base.css";
import "./view.css";
import "./controls.css";
import "./readout.css";
import "./design.css";
import "./narrow.css";

import { App } from "./app";

new App();
