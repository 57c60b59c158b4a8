// A page of a browser, by the debugging protocol.

const connected = url => new Promise((resolve, reject) => {
  const socket = new WebSocket(url);
  const waiting = new Map();
  let last = 0;
  socket.onerror = () => reject(new Error("no connection"));
  socket.onmessage = ({ data }) => {
    const { id, result, error } = JSON.parse(data);
    const [done, fail] = waiting.get(id) ?? [];
    waiting.delete(id);
    if (error) fail?.(new Error(error.message)); else done?.(result);
  };
  socket.onopen = () => resolve((method, params = {}, sessionId) => new Promise((done, fail) => {
    waiting.set(++last, [done, fail]);
    socket.send(JSON.stringify({ id: last, method, params, sessionId }));
  }));
});

export const connect = async browser => {
  const send = await connected(browser);
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
  const call = (method, params) => send(method, params, sessionId);
  const evaluate = async expression => {
    const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description}`);
    return result.value;
  };
  // Until an expression is true; the deadline is for a browser that has died.
  const until = async expression => {
    for (let k = 0; k < 600; k++) {
      if (await evaluate(`Boolean(${expression})`).catch(() => false)) return;
      await new Promise(done => setTimeout(done, 50));
    }
    const said = await evaluate(`document.getElementById("status")?.textContent`);
    throw new Error(`never: ${expression}; the page says: ${said}`);
  };
  return { call, evaluate, until };
};
