/**
 * The one door to the server.
 *
 * `unwrap` turns every answer that is not 2xx into an `ApiError` that carries the server's own sentence, and every
 * request that got no answer into a `ConnectionError`. Both also tell the connection store whether the server answers.
 */

import createClient from "openapi-fetch";
import { takeEarly } from "../early";
import { text } from "../strings";
import { useConnection } from "./connection";
import { REVIEWER_HEADER, reviewerHeader } from "./reviewer";
import type { paths } from "./schema.gen";

export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    message: string,
  ) {
    super(message);
    this.name = "ApiError";
  }
}

export class ConnectionError extends Error {
  constructor() {
    super(text.app.connectionError);
    this.name = "ConnectionError";
  }
}

function isAbort(cause: unknown): boolean {
  return cause instanceof DOMException && cause.name === "AbortError";
}

/** `fetch`, of what was asked for early too, noting whether the server answers. */
export async function trackedFetch(input: RequestInfo | URL, init?: RequestInit): Promise<Response> {
  try {
    const response = await (takeEarly(input) ?? fetch(input, init));
    useConnection.getState().answered();
    return response;
  } catch (cause) {
    if (isAbort(cause)) throw cause;
    useConnection.getState().failed();
    throw new ConnectionError();
  }
}

/** The error that a body of an answer that is not 2xx stands for. */
export function errorFromBody(status: number, body: unknown): ApiError {
  const detail = (body as { detail?: { code?: unknown; message?: unknown } } | null | undefined)?.detail;
  const code = typeof detail?.code === "string" ? detail.code : `http_${status}`;
  const message = typeof detail?.message === "string" ? detail.message : text.app.unknownError;
  return new ApiError(status, code, message);
}

/** Says who asks. No middleware of the client does it: each would put off the sending, and a decision is sent at once. */
function signedFetch(request: Request): Promise<Response> {
  const reviewer = reviewerHeader();
  if (reviewer) request.headers.set(REVIEWER_HEADER, reviewer);
  return trackedFetch(request);
}

export const api = createClient<paths>({ fetch: signedFetch });

type Answer<T> = { data?: T; error?: unknown; response: Response };

export async function unwrap<T>(request: Promise<Answer<T>>): Promise<T> {
  const { data, error, response } = await request;
  if (!response.ok) throw errorFromBody(response.status, error);
  return data as T;
}

export function messageOf(cause: unknown): string {
  return cause instanceof Error && cause.message ? cause.message : text.app.unknownError;
}
