// A client of the studio's protocol without a page: what the server says, for tests that need no browser and for those
// that compare a page with it.
import { request } from 'node:http';
import { require } from './packages.mjs';

const WebSocket = require('ws');

/** Exchanges the token of the opened URL for a cookie. */
export function cookieOf(program) {
  return new Promise((resolve, reject) => {
    const post = request(`${program.origin}/session`, { method: 'POST', headers: { Origin: program.origin } }, answer => {
      answer.resume();
      const cookie = answer.headers['set-cookie']?.[0]?.split(';')[0];
      if (answer.statusCode === 204 && cookie) resolve(cookie);
      else reject(new Error(`POST /session: ${answer.statusCode}`));
    });
    post.on('error', reject);
    post.end(program.token);
  });
}

export class Client {
  static async connect(program) {
    const self = new Client();
    self.origin = program.origin;
    self.cookie = await cookieOf(program);
    self.socket = new WebSocket(`${program.origin.replace('http', 'ws')}/socket`,
      { headers: { Cookie: self.cookie, Origin: program.origin }, maxPayload: 1 << 26 });
    self.socket.on('message', data => self.#receive(JSON.parse(data)));
    self.closed = new Promise(resolve => self.socket.on('close', resolve));
    await new Promise((resolve, reject) => { self.socket.on('open', resolve); self.socket.on('error', reject); });
    return self;
  }

  events = [];
  /** Meshes are acknowledged as they are announced, as a page does that draws them. */
  acknowledges = true;
  #next = 1;
  #replies = new Map();
  #waiting = [];

  /** Sends a request. @returns its reply; rejects with an Error that has a `code` if the reply is an error */
  async request(what, body = {}) {
    const reply = await this.ask(what, body);
    if (reply.error) throw Object.assign(new Error(`${what}: ${reply.error.text}`), { code: reply.error.code });
    return reply;
  }

  /** Sends a request. @returns its reply, whatever it is */
  ask(what, body = {}) {
    const id = this.#next++;
    this.socket.send(JSON.stringify({ id, do: what, ...body }));
    return new Promise(resolve => this.#replies.set(id, resolve));
  }

  /** The first event of this name, among those from place `since` on, that `test` accepts; waits for it. */
  event(name, test = () => true, { since = 0, timeout = 60_000 } = {}) {
    const found = this.events.slice(since).find(event => event.event === name && test(event));
    if (found) return Promise.resolve(found);
    return new Promise((resolve, reject) => {
      const late = setTimeout(() => reject(new Error(`no event ${name} within ${timeout} ms`)), timeout);
      this.#waiting.push({ accepts: event => event.event === name && test(event),
        resolve: event => { clearTimeout(late); resolve(event); } });
    });
  }

  /** SHA-256 of the present mesh as a binary PLY. */
  async digest() { return (await this.request('digest')).sha256; }

  /** @returns {Promise<Buffer>} what GET answers */
  get(path) {
    return new Promise((resolve, reject) => {
      request(`${this.origin}${path}`, { headers: { Cookie: this.cookie } }, answer => {
        const parts = [];
        answer.on('data', part => parts.push(part));
        answer.on('end', () => (answer.statusCode === 200 ? resolve(Buffer.concat(parts))
          : reject(new Error(`${path}: ${answer.statusCode}`))));
      }).on('error', reject).end();
    });
  }

  close() { this.socket.close(); }

  #receive(message) {
    if ('id' in message) {
      this.#replies.get(message.id)?.(message);
      this.#replies.delete(message.id);
      return;
    }
    this.events.push(message);
    if ('version' in message && this.acknowledges)
      this.socket.send(JSON.stringify({ id: this.#next++, do: 'ack', version: message.version }));
    const ready = this.#waiting.filter(waiting => waiting.accepts(message));
    this.#waiting = this.#waiting.filter(waiting => !ready.includes(waiting));
    for (const waiting of ready) waiting.resolve(message);
  }
}
