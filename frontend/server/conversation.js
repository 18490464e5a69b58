// @ts-check
// Questions that come many times a second, over one socket: to make a request of its own for each takes a browser longer
// than the server needs for the answer. Each question has an id, and its answer carries it.

/** @typedef {{id: number} & Record<string, any>} Told */

/** @param {() => URL} address @param {number} withinMs an answer takes longer only when there is nobody there */
export function createConversation(address, withinMs) {
  /** @type {WebSocket | null} */
  let socket = null;
  let last = 0;
  /** Those who wait for an answer, by the id of their question.
   * @type {Map<number, (answer: Told | null) => void>} */
  const waiting = new Map();

  /** Nobody waits any more: what they asked is to be asked otherwise. */
  function giveUp() {
    const left = [...waiting.values()];
    waiting.clear();
    for (const tell of left) tell(null);
  }

  function open() {
    const opened = new WebSocket(address());
    socket = opened;
    opened.onmessage = ({ data }) => {
      /** @type {Told} */
      const told = JSON.parse(data);
      waiting.get(told.id)?.(told);
      waiting.delete(told.id);
    };
    opened.onclose = () => {
      if (socket !== opened) return;
      socket = null;
      giveUp();
    };
    return opened;
  }

  return {
    /** @param {object} question
     * @returns {Promise<Told | null>} null: it is not open yet, or there is nobody; then it is to be asked otherwise */
    ask(question) {
      const present = socket ?? open();
      if (present.readyState !== WebSocket.OPEN) return Promise.resolve(null);
      last += 1;
      const id = last;
      return new Promise((resolve) => {
        const givingUp = setTimeout(() => present.close(), withinMs);
        waiting.set(id, (answer) => {
          clearTimeout(givingUp);
          resolve(answer);
        });
        present.send(JSON.stringify({ ...question, id }));
      });
    },
  };
}
