// The 3D view of a report: window.FeelerView.make(stage, buttons, meshes, colorOf).

import { makeStage } from "./stage.js";

window.FeelerView = { make: makeStage };
