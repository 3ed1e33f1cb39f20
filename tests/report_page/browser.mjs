// A page in headless Chromium, spoken to over the pipe of its debugging protocol: nothing to install but Chromium.
import {spawn, spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';

const patience_ms = 60000;

/** The command that starts Chromium here, or null. */
export function findChromium() {
  const names = [process.env.CHROMIUM, 'chromium', 'chromium-browser', 'google-chrome'].filter(Boolean);
  return names.find(name => spawnSync(name, ['--version'], {stdio: 'ignore'}).status === 0) ?? null;
}

const sleep = ms => new Promise(done => setTimeout(done, ms));

export class Browser {
  constructor(command) {
    this.profile = mkdtempSync(join(tmpdir(), 'prcage_browser_'));
    // Root in a container has no sandbox; nobody has a graphics card.
    this.process = spawn(command, ['--headless', '--no-sandbox', '--disable-dev-shm-usage', '--use-angle=swiftshader',
                                   '--enable-unsafe-swiftshader', '--no-first-run', '--disable-background-networking',
                                   '--window-size=1400,1000', `--user-data-dir=${this.profile}`,
                                   '--remote-debugging-pipe', 'about:blank'],
                         {stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe']});
    this.replies = new Map();
    this.listeners = new Set();
    this.received = '';
    this.process.stdio[4].setEncoding('utf8').on('data', text => this.receive(text));
    this.process.stdio[3].on('error', () => {});  // the end of the process says more
    let messages = '';
    this.process.stderr.setEncoding('utf8').on('data', text => messages += text);
    this.process.once('close', () => {
      for (const {failed} of this.replies.values()) failed(new Error(`the browser has ended\n${messages}`));
    });
  }

  receive(text) {
    const messages = (this.received + text).split('\0');
    this.received = messages.pop();
    for (const message of messages.map(JSON.parse)) {
      if (message.id === undefined) {
        for (const listener of this.listeners) listener(message);
        continue;
      }
      const {done, failed} = this.replies.get(message.id);
      this.replies.delete(message.id);
      message.error ? failed(new Error(message.error.message)) : done(message.result);
    }
  }

  send(method, params = {}, sessionId = undefined) {
    this.sent = (this.sent ?? 0) + 1;
    this.process.stdio[3].write(`${JSON.stringify({id: this.sent, method, params, sessionId})}\0`);
    return new Promise((done, failed) => this.replies.set(this.sent, {done, failed}));
  }

  async open(file) {
    const {targetId} = await this.send('Target.createTarget', {url: 'about:blank'});
    const {sessionId} = await this.send('Target.attachToTarget', {targetId, flatten: true});
    const page = new Page(this, sessionId);
    await page.load(file);
    return page;
  }

  async close() {
    if (this.process.exitCode === null && this.process.signalCode === null) {
      const ended = new Promise(done => this.process.once('exit', done));
      this.send('Browser.close').catch(() => {});
      const timer = setTimeout(() => this.process.kill('SIGKILL'), 5000);
      await ended;
      clearTimeout(timer);
    }
    rmSync(this.profile, {recursive: true, force: true, maxRetries: 5, retryDelay: 200});
  }
}

class Page {
  constructor(browser, session) {
    this.browser = browser;
    this.session = session;
    this.requests = [];  // of anything that is not within the page itself
    this.errors = [];
    browser.listeners.add(message => this.note(message));
  }

  send(method, params) { return this.browser.send(method, params, this.session); }

  note({sessionId, method, params}) {
    if (sessionId !== this.session) return;
    if (method === 'Network.requestWillBeSent' && !/^(data|blob):/.test(params.request.url)) {
      this.requests.push(params.request.url);
    }
    if (method === 'Runtime.exceptionThrown') {
      this.errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    }
    if (method === 'Runtime.consoleAPICalled' && ['error', 'assert', 'warning'].includes(params.type)) {
      this.errors.push(params.args.map(({value, description}) => value ?? description).join(' '));
    }
    if (method === 'Log.entryAdded' && params.entry.level === 'error') this.errors.push(params.entry.text);
  }

  async load(file) {
    for (const domain of ['Page', 'Runtime', 'Network', 'Log']) await this.send(`${domain}.enable`);
    this.url = pathToFileURL(file).href;
    const loaded = new Promise(done => this.browser.listeners.add(({sessionId, method}) => {
      if (sessionId === this.session && method === 'Page.loadEventFired') done();
    }));
    await this.send('Page.navigate', {url: this.url});
    await loaded;
    await this.until('document.documentElement.dataset.complete !== undefined');
  }

  async evaluate(expression) {
    const {result, exceptionDetails} =
        await this.send('Runtime.evaluate', {expression, returnByValue: true, awaitPromise: true});
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description}`);
    return result.value;
  }

  async until(condition) {
    for (const start = Date.now(); !await this.evaluate(`Boolean(${condition})`); await sleep(50)) {
      if (Date.now() - start > patience_ms) {
        throw new Error(`never: ${condition}\nerrors of the page: ${this.errors.join('\n')}`);
      }
    }
  }

  text(selector) { return this.evaluate(`document.querySelector(${JSON.stringify(selector)}).textContent`); }

  /** The box of an element, once it is in sight and has been painted there. */
  async bring(selector) {
    return this.evaluate(`(async () => {
      const element = document.querySelector(${JSON.stringify(selector)});
      element.scrollIntoView({block: 'center', behavior: 'instant'});
      for (let i = 0; i < 2; ++i) await new Promise(done => requestAnimationFrame(() => setTimeout(done)));
      const {x, y, width, height} = element.getBoundingClientRect();
      return {x, y, width, height, scrollX, scrollY};
    })()`);
  }

  /** As a user does: with the mouse. */
  async click(selector) {
    const box = await this.bring(selector);
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    for (const type of ['mouseMoved', 'mousePressed', 'mouseReleased']) {
      await this.send('Input.dispatchMouseEvent', {type, x, y, button: 'left', clickCount: 1});
    }
  }

  async type(selector, text) {
    await this.evaluate(`document.querySelector(${JSON.stringify(selector)}).focus()`);
    await this.send('Input.insertText', {text});
    await this.send('Input.dispatchKeyEvent', {type: 'keyUp', key: 'Shift'});
  }

  /** A PNG of an element, in base64. */
  async picture(selector) {
    const {x, y, width, height, scrollX, scrollY} = await this.bring(selector);
    const clip = {x: x + scrollX, y: y + scrollY, width, height, scale: 1};
    return (await this.send('Page.captureScreenshot', {format: 'png', clip})).data;
  }

  /** How much of a picture is not white, and how much of it differs from another picture. */
  compare(picture, other = picture) {
    return this.evaluate(`(async () => {
      const pixels = async base64 => {
        const image = new Image();
        image.src = 'data:image/png;base64,' + base64;
        await image.decode();
        const canvas = new OffscreenCanvas(image.width, image.height);
        const context = canvas.getContext('2d');
        context.drawImage(image, 0, 0);
        return context.getImageData(0, 0, image.width, image.height).data;
      };
      const [a, b] = [await pixels('${picture}'), await pixels('${other}')];
      let [drawn, different] = [0, 0];
      for (let i = 0; i < a.length; i += 4) {
        drawn += Math.min(a[i], a[i + 1], a[i + 2]) < 245;
        different += [0, 1, 2].some(k => Math.abs(a[i + k] - b[i + k]) > 20);
      }
      return {drawn: 4 * drawn / a.length, different: 4 * different / a.length};
    })()`);
  }
}
