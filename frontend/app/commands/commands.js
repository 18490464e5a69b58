// @ts-check
// All commands, by noun: the test of them goes through this list.

import * as answers from './answers.js';
import * as capture from './capture.js';
import * as device from './device.js';
import * as guide from './guide.js';
import * as library from './library.js';
import * as others from './others.js';
import * as told from './told.js';
import * as view from './view.js';
import * as work from './work.js';

export const COMMANDS = { answers, capture, device, guide, library, others, told, view, work };
