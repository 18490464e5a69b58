// @ts-check
// Shows the server's OpenAPI description with Swagger UI, which the server keeps at hand.

/** What Swagger UI's own script, loaded before this one, leaves behind.
 * @typedef {{SwaggerUIBundle: (options: Record<string, unknown>) => void}} SwaggerUi */
const { SwaggerUIBundle } = /** @type {SwaggerUi} */ (/** @type {unknown} */ (globalThis));

SwaggerUIBundle({ url: '/api/v1/openapi.json', dom_id: '#api', deepLinking: true, validatorUrl: null });
