// @ts-check
// Files on their way to the server, told of as they go: fetch doesn't tell.

/** @typedef {(sent: number) => void} OnSent   share of the file that is sent, from 0 to 1 */

/** Send a file; fails when nobody answers, when it takes too long, and when it is ended.
 * @param {URL} url @param {Record<string, string>} headers @param {File} file
 * @param {{ended: AbortSignal, withinMs: number, onSent: OnSent}} manner
 * @returns {Promise<{status: number, answer: any}>} answer: null when it is no JSON */
export function upload(url, headers, file, { ended, withinMs, onSent }) {
  return new Promise((resolve, reject) => {
    const sending = new XMLHttpRequest();
    const stop = () => sending.abort();
    const over = (/** @type {string} */ why) => () => reject(new Error(why));
    sending.open('POST', url);
    sending.responseType = 'json';
    sending.timeout = withinMs;
    for (const [name, value] of Object.entries(headers)) sending.setRequestHeader(name, value);
    sending.upload.onprogress = ({ loaded, total }) => onSent(total > 0 ? loaded / total : 1);
    sending.onload = () => resolve({ status: sending.status, answer: sending.response });
    sending.onerror = over('no connection');
    sending.ontimeout = over('it took too long');
    sending.onabort = over('it was ended');
    sending.onloadend = () => ended.removeEventListener('abort', stop);
    ended.addEventListener('abort', stop);
    sending.send(file);
    if (ended.aborted) stop();
  });
}

/** Whether a file can still be read: not once it has changed, or is gone.
 * @param {File} file */
export async function isReadable(file) {
  try {
    await file.slice(0, 1).arrayBuffer();
    return true;
  } catch {
    return false;
  }
}
