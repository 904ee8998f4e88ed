// Begins the page, with the logs that came with it.

import "./style.css";
import { App } from "./app";
import { given } from "./given";

const root = document.getElementById("app");
if (!root) throw new Error("the page has no place to draw in");
const app = new App(root);

const { a, b } = given();
if (a) app.open(a);
if (a && b) app.compare(b);
