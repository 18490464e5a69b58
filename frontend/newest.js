// @ts-check
// One job at a time, and of those that wait only the newest.

/**
 * Wrap a job so that calls never pile up: while one runs, only the last call since is kept, and it runs next.
 * @param {() => Promise<void>} job
 */
export function newestWins(job) {
  let running = false;
  let wanted = false;
  return async () => {
    wanted = true;
    if (running) return;
    running = true;
    try {
      while (wanted) {
        wanted = false;
        await job();
      }
    } finally {
      running = false;
    }
  };
}
