// @ts-check
// Questions that come many times a second, over one socket: to make a request of its own for each takes a browser longer
// than the server needs for the answer.

/** @param {() => URL} address @param {number} withinMs an answer takes longer only when there is nobody there */
export function createConversation(address, withinMs) {
  /** @type {WebSocket | null} */
  let socket = null;
  /** Those who wait for an answer: they come in the order of the questions.
   * @type {((answer: string | null) => void)[]} */
  let waiting = [];

  function open() {
    const opened = new WebSocket(address());
    socket = opened;
    opened.onmessage = ({ data }) => waiting.shift()?.(data);
    opened.onclose = () => {
      socket = null;
      const left = waiting;
      waiting = [];
      for (const tell of left) tell(null);
    };
    return opened;
  }

  return {
    /** @param {unknown} question
     * @returns {Promise<string | null>} null: it is not open yet, or there is nobody; then it is to be asked otherwise */
    ask(question) {
      const present = socket ?? open();
      if (present.readyState !== WebSocket.OPEN) return Promise.resolve(null);
      return new Promise((resolve) => {
        const givingUp = setTimeout(() => present.close(), withinMs);
        waiting.push((answer) => {
          clearTimeout(givingUp);
          resolve(answer);
        });
        present.send(JSON.stringify(question));
      });
    },
  };
}
