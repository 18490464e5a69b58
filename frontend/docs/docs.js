// Shows the server's OpenAPI description with Swagger UI, which the server keeps at hand.
/* global SwaggerUIBundle */

SwaggerUIBundle({ url: '/api/v1/openapi.json', dom_id: '#api', deepLinking: true, validatorUrl: null });
