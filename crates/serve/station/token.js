// The token that servers may demand: asked for once, and kept for as long as the browser's tab is open.
import { by, input, say } from './dom.js';

const KEY = 'token';
/** What servers take for one, and WebSockets can offer. */
const TOKEN = /^[\w.~-]{16,256}$/;

/** What requests carry. @returns {Record<string, string>} */
export function tokenHeaders() {
  const token = sessionStorage.getItem(KEY);
  return token ? { Authorization: `Bearer ${token}` } : {};
}

/** What WebSockets offer, which can't have headers of their own. */
export function tokenProtocols() {
  const token = sessionStorage.getItem(KEY);
  return token ? ['deltarobot', `deltarobot.token.${token}`] : [];
}

/** Asks for one. @returns {Promise<void>} once it was given; whether it is the right one, the server knows */
export function askToken() {
  const dialog = /** @type {HTMLDialogElement} */ (by('token'));
  say(by('token-note'), sessionStorage.getItem(KEY) ? 'The server does not know this token.' : '');
  input('token-value').value = '';
  return new Promise((resolve) => {
    by('token-form').onsubmit = (event) => {
      event.preventDefault();
      const token = input('token-value').value.trim();
      if (!TOKEN.test(token)) return say(by('token-note'), 'A token has 16 to 256 letters, digits or characters of -._~');
      sessionStorage.setItem(KEY, token);
      dialog.onclose = () => resolve();
      dialog.close();
    };
    // Nothing can be seen or done without: Escape does not help.
    dialog.onclose = () => dialog.showModal();
    dialog.showModal();
  });
}
